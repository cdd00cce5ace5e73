"""An adapter that breaks the contract is told which clause it broke."""

import math

import pytest

from harness.engines.conformance import CLAUSES, ClauseResult, ClauseStatus, conform
from harness.engines.conformance.suite import within
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
    Slippery,
    Sound,
    Sparse,
    TakesAnything,
    Toy,
    Unpicklable,
    Untidy,
    WrongShape,
)


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
    Sparse: {"dense": "largest turn"},
    Overshoots: {"ends": "horizon"},
    Ghost: {"flight": "a point but no force"},
    TakesAnything: {"unknown setting": "was taken", "wrong value": "another kind: integrator"},
    Keeps: {"report": "settings differ in build, condim"},
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
        "laws of effects",
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
