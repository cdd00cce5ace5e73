"""An adapter that breaks the contract is told which clause it broke."""

import math
from typing import Any

import pytest

from harness.core.case import Case
from harness.engines.conformance import CLAUSES, ClauseResult, ClauseStatus, conform
from harness.engines.conformance.suite import Fixture, within
from harness.engines.description import Description, Precision
from harness.engines.parity.checks import parity
from models import Scene
from tests.harness.conformance.toys import (
    BackwardsInTime,
    Cheerful,
    Confuses,
    Falls,
    Ghost,
    Heavy,
    Keeps,
    Late,
    Level,
    Nervous,
    NotANumber,
    Overshoots,
    RaisesOnDivergence,
    Random,
    Remembers,
    Single,
    Slippery,
    Sound,
    Sparse,
    TakesAnything,
    Toy,
    Transposed,
    Unpicklable,
    Untidy,
    WrongShape,
)
from tests.support.engines import stepping_engine


def told(verdicts: tuple[ClauseResult, ...], result: ClauseStatus) -> dict[str, str]:
    """Return the details of the checks that ended so, by name."""
    return {verdict.name: verdict.detail for verdict in verdicts if verdict.result is result}


BROKEN = {
    WrongShape: {"trajectory": r"`position` has shape \(\d+, 2\)"},
    BackwardsInTime: {"trajectory": "increase strictly"},
    NotANumber: {"trajectory": "`velocity` is no number at sample 0"},
    RaisesOnDivergence: {"divergence": "FloatingPointError: the numbers exploded"},
    Cheerful: {"divergence": "without bound, and the outcome is FINISHED"},
    Random: {"repeats": "two runs of one case differ"},
    Remembers: {"repeats after another": "otherwise after another case"},
    Late: {"newton": "misfit", "same instant": "distance"},
    Falls: {"initial state": "first sample"},
    Heavy: {"mass properties": "moments", "acceleration at release": "first step"},
    Transposed: {"laws of effects": "tilt: misfit of the gyroscopic acceleration"},
    Sparse: {"dense": "largest turn"},
    Overshoots: {"ends": "horizon"},
    Ghost: {"flight": "a point but no force"},
    TakesAnything: {"unknown setting": "was taken", "wrong value": "another kind: integrator"},
    Keeps: {"report": "settings differ in build, .*condim"},
    Level: {"motion with effects": "tilt 1"},
    Untidy: {
        "name": "'My Engine'",
        "version": "None is no text",
        "settings": "declared twice: cone",
        "capabilities": "no effect of a scene: magnetism",
    },
    Slippery: {"friction": "beyond the declared"},
    Unpicklable: {"pickling": "pickle"},
    Nervous: {"horizon": "shorter run"},
    Confuses: {"repeats in a batch": "case 2 of 4: `simulate` answered another case"},
}


@pytest.fixture(scope="module")
def sound() -> tuple[ClauseResult, ...]:
    """Return the results of an adapter that breaks nothing."""
    return conform(Sound())


def test_a_sound_toy_keeps_every_clause(sound: tuple[ClauseResult, ...]) -> None:
    assert told(sound, ClauseStatus.FAILED) == {}


ALLOWED = {
    "initial state": 16.0 * 2.0**-52,  # relative: a few roundings
    "acceleration at release": 0.01,  # g
    "acceleration": 0.6,  # of the error, at half the timestep
    "friction": 1e-3,  # beyond the declared
    "motion with effects": 0.1,  # of what an effect does
    "newton": 0.6,  # of the change of the force from sample to sample
    "same instant": 0.1,  # of the way of the contact point from sample to sample
}
"""As the docstrings have it, and not imported: whoever changes one is told."""


def test_each_clause_allows_what_its_docstring_says(sound: tuple[ClauseResult, ...]) -> None:
    allowed = {result.name: result.allowed for result in sound}
    assert {name: allowed[name] for name in ALLOWED} == ALLOWED


@pytest.mark.parametrize(
    ("number", "passes"), [(0.5, True), (0.6, True), (0.6001, False), (math.nan, False)]
)
def test_a_number_is_at_most_what_is_allowed(number: float, *, passes: bool) -> None:
    found = within(number, 0.6, "1", "what was measured").result
    assert found is (ClauseStatus.PASSED if passes else ClauseStatus.FAILED)


@pytest.mark.slow
@pytest.mark.parametrize("toy", BROKEN, ids=lambda toy: toy.__name__)
def test_a_broken_adapter_is_told_its_clause(toy: type[Toy]) -> None:
    failed = told(conform(toy()), ClauseStatus.FAILED)
    for name, detail in BROKEN[toy].items():
        assert name in failed
        with pytest.raises(AssertionError, match=detail):
            raise AssertionError(failed[name])


def test_every_clause_can_be_broken() -> None:
    broken = {name for clauses in BROKEN.values() for name in clauses}
    # these need a registered engine, a compiled world, a solver without timesteps, or arrays that
    # Trajectory refuses
    unbroken = {
        "unsupported effect",
        "repeats in a fresh process",
        "starts",
        "acceleration",
    }
    assert broken | unbroken == CLAUSES.keys()


def test_what_needs_a_run_is_not_asked_without_one() -> None:
    verdicts = conform(WrongShape())
    skipped = told(verdicts, ClauseStatus.NOT_APPLICABLE)
    assert "needs a run that passes the check 'trajectory'" in skipped["newton"]
    assert told(verdicts, ClauseStatus.FAILED).keys() == {"trajectory", "divergence"}


def clause_of(toy: Toy, name: str) -> ClauseResult:
    """Return what one clause says of a toy."""
    return CLAUSES[name].look(Fixture(toy))


def test_forces_that_an_engine_does_not_tell_are_not_judged() -> None:
    late = Late()
    assert clause_of(late, "newton").result is ClauseStatus.FAILED
    late.description = Description(tells_forces=False)
    for name in ("newton", "friction"):
        found = clause_of(late, name)
        assert found.result is ClauseStatus.NOT_APPLICABLE
        assert found.detail == "the engine does not tell the force that moves the can"
    assert clause_of(late, "same instant").result is ClauseStatus.FAILED


def test_an_engine_in_single_precision_is_allowed_its_round_off() -> None:
    single = Single()
    assert clause_of(single, "initial state").result is ClauseStatus.FAILED
    assert clause_of(single, "mass properties").result is ClauseStatus.FAILED
    single.description = Description(precision=Precision.SINGLE)
    for name in ("initial state", "mass properties"):
        found = clause_of(single, name)
        assert found.result is ClauseStatus.PASSED
        assert found.number is not None
        assert found.number > 1e-9  # or nothing was rounded


def test_a_spin_in_the_frame_of_the_body_is_a_mismatch(brief: Scene) -> None:
    case = Case(scene=brief, engine="toy", timestep=1e-3)

    def differing(toy: Any) -> dict[str, float]:
        rows = parity(toy.open(case), brief, 1e-3, {})
        return {row.quantity: row.found for row in rows if row.verdict != "equal"}

    class Upright(Toy):
        def open(self, case: Case) -> Any:
            return stepping_engine("mujoco").open(case)

    assert differing(Upright()) == {}
    # of 85; methods of the first order may differ by some thousandths of that
    assert differing(Transposed())["misfit of the gyroscopic acceleration"] > 30.0
