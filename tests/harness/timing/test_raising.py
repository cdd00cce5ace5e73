"""An engine of somebody else's that raises is not timed, and nothing else is lost."""

import pytest

from harness import runner
from harness.case import Case
from harness.engines.base import Capabilities
from harness.errors import SpeechlessEngineError
from harness.simulation import Outcome, Simulation
from harness.timing import alone, overhead
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
    for module in (alone, overhead, runner):
        monkeypatch.setattr(module, "engine", lambda _: Raising())
    return Case(scene=brief, engine="raising", timestep=1e-3)


def test_it_is_untimed(case: Case) -> None:
    assert alone.time_alone(case) == alone.untimed(case)
    assert overhead.overhead(case) == {"ways": {}}


def test_a_case_of_which_it_no_longer_says_the_timestep_is_broken(
    case: Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(case: Case) -> None:
        raise SpeechlessEngineError(case.engine, case.label(), "the licence is gone")

    monkeypatch.setattr(runner, "check", refuse)
    monkeypatch.setattr(runner, "timestep_of", refuse)
    found = runner.attempt(case).simulation
    assert found.outcome is Outcome.BROKEN
    assert "the licence is gone" in found.note
