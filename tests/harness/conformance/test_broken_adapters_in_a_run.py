"""An adapter that breaks its contract is an outcome that names the fault; the other cases go on."""

from collections.abc import Callable
from concurrent.futures import Executor, Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.cli.catalogue import engines_answer
from harness.core.case import Case
from harness.core.engine_packages import ENGINE_ENTRY_POINTS
from harness.core.errors import BrokenEngineError, InvalidSettingError, RefusedModelError
from harness.core.simulation import Outcome, ParityRow, Simulation
from harness.engines import registry
from harness.engines.base import Capabilities
from harness.evaluation.evaluate import evaluate
from harness.evaluation.run_cases import run_cases
from harness.execution.cache import CacheFolder
from harness.execution.cache_entry import Metadata
from harness.execution.isolated_pool import SerialExecutor
from models import Scene
from tests.support.trajectories import changed, path_of

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
        return changed(good, **{name: values})

    return spoil


def narrow(good: Simulation) -> Simulation:
    return changed(good, position=path_of(good).position[:, :2])


def backwards(good: Simulation) -> Simulation:
    return changed(good, time=path_of(good).time[::-1])


def late(good: Simulation) -> Simulation:
    return changed(good, time=path_of(good).time + 1.0)


def raising(good: Simulation) -> Simulation:
    del good
    raise ZeroDivisionError("as it does")


def mute(good: Simulation) -> Simulation:
    class MuteError(Exception):
        def __str__(self) -> str:
            raise ValueError(good.note)

    raise MuteError


def with_field(name: str, value: Any) -> Spoil:
    """Return what puts something into a field of the simulation."""
    field: dict[str, Any] = {name: value}
    return lambda good: replace(good, **field)


def untouched(good: Simulation) -> Simulation:
    """Claim a contact where no point is."""
    return changed(good, contact_point=np.full_like(path_of(good).contact_point, np.nan))


def uncounted(good: Simulation) -> Simulation:
    return changed(good, contact_count=-np.ones_like(path_of(good).contact_count))


NO_WORD: Any = np.ones(2)
ROW = ParityRow(quantity="mass", unit="kg", declared=1.0, found=1.0, how="read", verdict="equal")


def unnormalised(good: Simulation) -> Simulation:
    return changed(good, quaternion=2.0 * path_of(good).quaternion)


FAULTS: dict[str, tuple[Spoil, str]] = {
    "wrong shape": (narrow, r"`position` has shape \(\d+, 2\), but \d+ samples need \(\d+, 3\)"),
    "time runs backwards": (backwards, "`time` must hold .* increase strictly"),
    "time starts late": (late, "`time` starts at 1.0 s, not at the release"),
    "NaN in the state": (with_nan("position"), r"`position` is no number at sample 1 of \d+"),
    "NaN in the force": (with_nan("contact_force"), "`contact_force` is no number at sample 1"),
    "raises": (raising, "`simulate` raised ZeroDivisionError: as it does"),
    "no simulation": (lambda _: None, "`simulate` returned NoneType, not a Simulation"),
    "no trajectory": (
        lambda good: with_field("trajectory", path_of(good).time)(good),
        "`trajectory` is ndarray, not a Trajectory",
    ),
    "another case": (
        lambda good: replace(good, case=replace(good.case, profile="default")),
        "`simulate` answered another case, .* default",
    ),
    "long quaternion": (unnormalised, "`quaternion` is off unit length by 1.0e"),
    "raises what cannot be said": (mute, "`simulate` raised MuteError$"),
    "outcome": (with_field("outcome", "FINISHED"), "`outcome` is 'FINISHED', not an Outcome"),
    "note": (with_field("note", 3), "`note` is 3, not text"),
    "note of half a character": (with_field("note", "\ud800"), "`note` is str, not text"),
    "steps": (with_field("steps", "many"), "`steps` is 'many', not a whole number"),
    "steps of 401 digits": (with_field("steps", 10**400), "`steps` is int, not a whole number"),
    "time": (with_field("cpu_s", "x"), "`cpu_s` is 'x', not a number of seconds"),
    "no time": (with_field("wall_s", np.nan), "`wall_s` is nan, not a number of seconds"),
    "version": (with_field("engine_version", None), "`engine_version` is NoneType, not text"),
    "timestep": (with_field("timestep", -1.0), "`timestep` is -1.0, not a positive number"),
    "setting": (with_field("settings", {"a": np.ones(2)}), "`settings` has ndarray as 'a'"),
    "name of a setting": (with_field("settings", {1: 2}), "`settings` has a name that is 1, not"),
    "parity": (with_field("parity", ("x",)), "`parity` holds 'x', not ParityRow"),
    "parity table": (with_field("parity", [ROW]), "`parity` is list, not a tuple"),
    "row": (
        with_field("parity", (replace(ROW, verdict=NO_WORD),)),
        "`verdict` of a row of `parity` is ndarray, not equal, imposed, mismatch or does not apply",
    ),
    "contact nowhere": (untouched, "`contact_point` is no number at sample 0, where there is a"),
    "negative count": (uncounted, r"`contact_count` is -1 at sample 0 of \d+"),
}


@pytest.fixture
def spoilt(monkeypatch: pytest.MonkeyPatch, brief: Scene) -> Callable[[Spoil], Case]:
    """Return a function that registers a spoilt engine and returns a case for it."""

    def register(spoil: Spoil) -> Case:
        real = registry.engine
        for module in ("evaluation.evaluate", "evaluation.case_cache", "engines.registry"):
            monkeypatch.setattr(
                f"harness.{module}.engine",
                lambda name: Spoilt(spoil) if name == "spoilt" else real(name),
            )
        monkeypatch.setattr("harness.evaluation.evaluate.check_effects", lambda *_: None)
        # it is not registered, and so nothing is known of where it comes from
        monkeypatch.setattr(
            "harness.evaluation.case_cache.case_key", lambda case: case.label().replace(" ", "-")
        )
        monkeypatch.setattr(
            "harness.evaluation.case_cache.case_metadata", lambda case: Metadata(label=case.label())
        )
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


@pytest.mark.parametrize("executor", [None, SerialExecutor()])
def test_the_other_cases_go_on(
    spoilt: Callable[[Spoil], Case], brief: Scene, executor: Executor | None
) -> None:
    broken = spoilt(raising)
    good = Case(scene=brief, engine="reference")
    outcomes = [e.simulation.outcome for e in run_cases([good, broken, good], executor)]
    assert outcomes == [Outcome.FINISHED, Outcome.BROKEN, Outcome.FINISHED]


def refusing(good: Simulation) -> object:
    raise InvalidSettingError("model", good.case.engine, "another")


def unsendable(good: Simulation) -> Simulation:
    return replace(good, note=type("Words", (str,), {})("of a kind of its own"))


def overflowing(good: Simulation) -> Simulation:
    """Move at a speed whose square is no number."""
    return changed(good, velocity=np.full_like(path_of(good).velocity, 1e300))


@pytest.mark.parametrize(
    ("spoil", "note"),
    [
        (refusing, "`simulate` raised InvalidSettingError: setting 'model' cannot be 'spoilt'"),
        (unsendable, "`pickle` raised "),
        (overflowing, "`measure` raised RuntimeWarning: overflow"),  # an error in tests
        *((spoil, "") for spoil, _ in FAULTS.values()),
    ],
)
def test_whatever_it_does_is_its_outcome_and_kept(
    spoilt: Callable[[Spoil], Case],
    brief: Scene,
    tmp_path: Path,
    spoil: Spoil,
    note: str,
) -> None:
    broken, good = spoilt(spoil), Case(scene=brief, engine="reference")
    store = CacheFolder(folder=tmp_path)
    done = run_cases([broken, good], store=store)
    assert [e.simulation.outcome for e in done] == [Outcome.BROKEN, Outcome.FINISHED]
    assert done[0].simulation.note.startswith(note)
    assert done[0].simulation.note
    kept = run_cases([broken, good], Dying(), store=store)
    assert [e.simulation.note for e in kept] == [e.simulation.note for e in done]


def test_wrong_use_that_our_own_engine_finds_names_the_case_and_what_is_kept(
    brief: Scene, tmp_path: Path
) -> None:
    good = Case(scene=brief, engine="reference")
    wrong = Case(scene=brief, engine="mujoco", options=(("condim", 2),))
    with pytest.raises(RefusedModelError) as caught:
        run_cases([good, wrong], store=CacheFolder(folder=tmp_path))
    case, kept = caught.value.__notes__
    assert case == f"It is of the case '{wrong.label()}'."
    assert kept.startswith("1 of 2 are done and kept in ")


class Dying(Executor):
    """A pool whose process dies of the case it is given second; what comes after is refused."""

    def __init__(self) -> None:
        self.given = 0

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> "Future[Any]":
        """Run the first, and lose the second."""
        self.given += 1
        if self.given > 2:
            raise BrokenProcessPool("no process is left")
        future: Future[Any] = Future()
        if self.given == 1:
            future.set_result(fn(*args, **kwargs))
        else:
            future.set_exception(BrokenProcessPool("a process was terminated abruptly"))
        return future


def test_a_process_that_dies_leaves_a_named_outcome_and_what_was_done(brief: Scene) -> None:
    case = Case(scene=brief, engine="reference")
    done = run_cases([case, case, case], Dying())
    outcomes = [e.simulation.outcome for e in done]
    assert outcomes == [Outcome.FINISHED, Outcome.STOPPED, Outcome.STOPPED]
    assert "terminated abruptly" in done[1].simulation.note
    assert "no process is left" in done[2].simulation.note


@pytest.mark.parametrize(
    ("entry", "reason"),
    [
        ("harness.core.errors:NoSuchEngine", "AttributeError"),
        ("harness.core.case:Case", "TypeError"),
    ],
)
def test_an_engine_that_cannot_be_made_is_named(
    monkeypatch: pytest.MonkeyPatch, entry: str, reason: str
) -> None:
    real = registry._entries()  # noqa: SLF001 - there is no other way to plant an entry point
    planted = EntryPoint(name="planted", value=entry, group=ENGINE_ENTRY_POINTS)
    monkeypatch.setattr(registry, "_entries", lambda: real | {"planted": planted})
    with pytest.raises(BrokenEngineError) as caught:
        registry.engine("planted")
    assert (caught.value.engine, caught.value.entry) == ("planted", entry)
    assert caught.value.reason.startswith(f"{reason}: ")
    told = {each["name"]: each for each in engines_answer(None)["engines"]}
    assert told["planted"]["installed"] is False
    assert told["mujoco"]["installed"] is True


def test_wrong_use_still_raises(spoilt: Callable[[Spoil], Case]) -> None:
    case = spoilt(refusing)
    with pytest.raises(InvalidSettingError) as caught:
        evaluate(case)
    assert caught.value.value == "spoilt"
