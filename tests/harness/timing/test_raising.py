"""An engine of somebody else's that raises is not timed, and nothing else is lost."""

import pytest

from harness.core.case import Case
from harness.core.errors import EngineContractError
from harness.core.simulation import Outcome, Simulation
from harness.engines.base import Capabilities
from harness.evaluation import evaluate, timing
from models import Scene


class Raising:
    """Raises whatever it is asked for, but its timestep."""

    name, version, settings = "raising", "1", ()
    capabilities = Capabilities(honours=frozenset(), imposes={})

    def timestep(self, case: Case) -> float:
        """Return the timestep of a case, s."""
        return case.timestep or 1e-3

    def simulate(self, case: Case) -> Simulation:
        """Fail."""
        raise ZeroDivisionError(case.engine)

    def open(self, case: Case) -> object:
        """Fail."""
        raise ZeroDivisionError(case.engine)


@pytest.fixture
def case(brief: Scene, monkeypatch: pytest.MonkeyPatch) -> Case:
    """Return a case of an engine that raises."""
    for module in (timing, evaluate):
        monkeypatch.setattr(module, "engine", lambda _: Raising())
    return Case(scene=brief, engine="raising", timestep=1e-3)


def test_it_is_untimed(case: Case) -> None:
    assert timing.time_alone(case) == timing.untimed(case)
    assert timing.overhead(case) == {"ways": {}}


def test_a_case_of_which_it_no_longer_says_the_timestep_is_broken(
    case: Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(case: Case) -> None:
        raise EngineContractError(case.engine, case.label(), "the licence is gone")

    monkeypatch.setattr(evaluate, "check_case", refuse)
    monkeypatch.setattr(evaluate, "timestep_of", refuse)
    found = evaluate.evaluate_case(case).simulation
    assert found.outcome is Outcome.BROKEN
    assert "the licence is gone" in found.note
