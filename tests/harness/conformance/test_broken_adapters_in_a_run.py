"""An adapter that breaks its contract is an outcome that names the fault; the other cases go on."""

from collections.abc import Callable
from concurrent.futures import Executor, Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from importlib.metadata import EntryPoint

import numpy as np
import pytest

from harness.case import Case
from harness.cli.listings import engines_answer
from harness.engines import registry
from harness.engines.base import Capabilities
from harness.errors import BrokenEngineError, InvalidSettingError
from harness.executors import Serial
from harness.runner import evaluate, run
from harness.simulation import Outcome, Simulation
from models import Scene

Spoil = Callable[[Simulation], object]


class Spoilt:
    """The reference, whose answers are spoilt."""

    settings = ()
    version = "1"
    capabilities = Capabilities(honours=frozenset(), imposes={})

    def __init__(self, spoil: Spoil) -> None:
        self.name = "spoilt"
        self._spoil = spoil

    def timestep(self, case: Case) -> None:
        """Return None: the solver chooses its own steps."""
        del case

    def simulate(self, case: Case) -> object:
        """Return a spoilt answer."""
        whole = registry.engine("reference").simulate(replace(case, engine="reference"))
        return self._spoil(replace(whole, case=case))


def with_nan(name: str) -> Spoil:
    """Return what puts a NaN into the second sample of a field."""

    def spoil(good: Simulation) -> Simulation:
        values = np.array(getattr(good.trajectory, name))
        values[1] = np.nan
        return replace(good, trajectory=replace(good.trajectory, **{name: values}))

    return spoil


def narrow(good: Simulation) -> Simulation:
    position = good.trajectory.position[:, :2]
    return replace(good, trajectory=replace(good.trajectory, position=position))


def backwards(good: Simulation) -> Simulation:
    return replace(good, trajectory=replace(good.trajectory, time=good.trajectory.time[::-1]))


def late(good: Simulation) -> Simulation:
    return replace(good, trajectory=replace(good.trajectory, time=good.trajectory.time + 1.0))


def raising(good: Simulation) -> Simulation:
    del good
    raise ZeroDivisionError("as it does")


def unnormalised(good: Simulation) -> Simulation:
    quaternion = 2.0 * good.trajectory.quaternion
    return replace(good, trajectory=replace(good.trajectory, quaternion=quaternion))


FAULTS: dict[str, tuple[Spoil, str]] = {
    "wrong shape": (narrow, r"`position` has shape \(\d+, 2\), but \d+ samples need \(\d+, 3\)"),
    "time runs backwards": (backwards, "`time` must hold .* increase strictly"),
    "time starts late": (late, "`time` starts at 1.0 s, not at the release"),
    "NaN in the state": (with_nan("position"), r"`position` is no number at sample 1 of \d+"),
    "NaN in the force": (with_nan("contact_force"), "`contact_force` is no number at sample 1"),
    "raises": (raising, "`simulate` raised ZeroDivisionError: as it does"),
    "no simulation": (lambda _: None, "`simulate` returned NoneType, not a Simulation"),
    "no trajectory": (
        lambda good: replace(good, trajectory=good.trajectory.time),
        "`trajectory` is ndarray, not a Trajectory",
    ),
    "another case": (
        lambda good: replace(good, case=replace(good.case, profile="default")),
        "`simulate` answered another case, .* default",
    ),
    "long quaternion": (unnormalised, "`quaternion` is off unit length by 1.0e"),
}


@pytest.fixture
def spoilt(monkeypatch: pytest.MonkeyPatch, brief: Scene) -> Callable[[Spoil], Case]:
    """Return a function that registers a spoilt engine and returns a case for it."""

    def register(spoil: Spoil) -> Case:
        real = registry.engine
        monkeypatch.setattr(
            "harness.runner.engine", lambda name: Spoilt(spoil) if name == "spoilt" else real(name)
        )
        monkeypatch.setattr("harness.runner.check_effects", lambda *_: None)
        return Case(scene=brief, engine="spoilt")

    return register


@pytest.mark.parametrize("name", FAULTS)
def test_the_fault_is_named(spoilt: Callable[[Spoil], Case], name: str) -> None:
    spoil, message = FAULTS[name]
    evaluation = evaluate(spoilt(spoil))
    assert evaluation.simulation.outcome is Outcome.BROKEN
    assert evaluation.motion is None
    assert evaluation.simulation.engine_version == "1"
    with pytest.raises(AssertionError, match=message):
        raise AssertionError(evaluation.simulation.note)


def test_an_answer_that_is_not_spoilt_is_no_fault(spoilt: Callable[[Spoil], Case]) -> None:
    assert evaluate(spoilt(lambda good: good)).simulation.outcome is Outcome.FINISHED


@pytest.mark.parametrize("executor", [None, Serial()])
def test_the_other_cases_go_on(
    spoilt: Callable[[Spoil], Case], brief: Scene, executor: Executor | None
) -> None:
    broken = spoilt(raising)
    good = Case(scene=brief, engine="reference")
    outcomes = [e.simulation.outcome for e in run([good, broken, good], executor)]
    assert outcomes == [Outcome.FINISHED, Outcome.BROKEN, Outcome.FINISHED]


class Dying(Executor):
    """A pool whose process dies of the case it is given second; what comes after is refused."""

    def __init__(self) -> None:
        self.given = 0

    def submit(self, fn, /, *args, **kwargs):  # noqa: ANN001, ANN002, ANN003, ANN201, D102
        self.given += 1
        if self.given > 2:
            raise BrokenProcessPool("no process is left")
        future: Future = Future()
        if self.given == 1:
            future.set_result(fn(*args, **kwargs))
        else:
            future.set_exception(BrokenProcessPool("a process was terminated abruptly"))
        return future


def test_a_process_that_dies_leaves_a_named_outcome_and_what_was_done(brief: Scene) -> None:
    case = Case(scene=brief, engine="reference")
    done = run([case, case, case], Dying())
    outcomes = [e.simulation.outcome for e in done]
    assert outcomes == [Outcome.FINISHED, Outcome.STOPPED, Outcome.STOPPED]
    assert "terminated abruptly" in done[1].simulation.note
    assert "no process is left" in done[2].simulation.note


@pytest.mark.parametrize(
    ("entry", "reason"),
    [("harness.errors:NoSuchEngine", "AttributeError"), ("harness.case:Case", "TypeError")],
)
def test_an_engine_that_cannot_be_made_is_named(
    monkeypatch: pytest.MonkeyPatch, entry: str, reason: str
) -> None:
    real = registry._entries()  # noqa: SLF001 - there is no other way to plant an entry point
    planted = EntryPoint(name="planted", value=entry, group=registry.GROUP)
    monkeypatch.setattr(registry, "_entries", lambda: real | {"planted": planted})
    with pytest.raises(BrokenEngineError, match=f"'planted'.*{entry}.*{reason}"):
        registry.engine("planted")
    told = {each["name"]: each for each in engines_answer(None)["engines"]}
    assert told["planted"]["installed"] is False
    assert told["mujoco"]["installed"] is True


def test_wrong_use_still_raises(spoilt: Callable[[Spoil], Case]) -> None:
    def refuse(good: Simulation) -> object:
        raise InvalidSettingError("model", good.case.engine, "another")

    case = spoilt(refuse)
    with pytest.raises(InvalidSettingError, match="cannot be 'spoilt'"):
        evaluate(case)
