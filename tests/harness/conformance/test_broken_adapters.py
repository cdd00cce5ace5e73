"""An adapter that breaks the contract is told which clause it broke."""

import pytest

from harness.engines.conformance import CLAUSES, ClauseResult, ClauseStatus, conform
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


def test_a_sound_toy_keeps_every_clause() -> None:
    assert told(conform(Sound()), ClauseStatus.FAILED) == {}


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
