"""What is said of a motion that is not sure; elsewhere tests ask for kinds and shares."""

import math

import pytest

from reference.analysis.agreement import Agreement
from reference.analysis.conditioning import Lost, RoundOff

UNSURE: list[tuple[RoundOff | Agreement, str]] = [
    (
        RoundOff(lost=Lost.ENERGY, share=2.3e-7),
        (
            "At its highest the can all but balances, and round-off of the energy is up to 2e-07 "
            "of what is left: the motion is known to no more than that."
        ),
    ),
    (
        RoundOff(lost=Lost.FORCE, share=2.3e-7),
        (
            "Beside steady rolling the forces on phi cancel, and round-off is up to 2e-07 of what "
            "is left: the motion is known to no more than that."
        ),
    ),
    (
        RoundOff(lost=Lost.NEIGHBOURS, share=2.3e-7),
        (
            "Beside the balancing angle one ulp of phi changes the force on it by 2e-07 of itself: "
            "the motion is that of exactly the numbers given."
        ),
    ),
    (Agreement(quantity="turn", discrepancy=1e-12, allowed=1e-11, evaluations=1), ""),
    (
        Agreement(quantity="turn", discrepancy=2e-8, allowed=3e-8, evaluations=1),
        (
            "The closed motion and the integration part by 2.0e-08 in the turn, and round-off "
            "allows 3.0e-08: the motion is known to no more than that."
        ),
    ),
    (
        Agreement(quantity="turn", discrepancy=2e-8, allowed=1e-12, evaluations=1),
        (
            "The closed motion and the integration part by 2.0e-08 in the turn, where round-off "
            "allows 1.0e-12: one of them is wrong. This is the integration's."
        ),
    ),
    (
        Agreement(quantity="turn", discrepancy=math.inf, allowed=1e-12, evaluations=1),
        (
            "The closed motion and the integration end otherwise, where round-off allows 1.0e-12: "
            "one of them is wrong. This is the integration's."
        ),
    ),
    (
        Agreement(quantity="", discrepancy=1.0, allowed=0.0, refused=True, ulp=3e-9, evaluations=1),
        (
            "The closed motion is lost in round-off. This is the integration's, of which one ulp "
            "of each number moves a quantity by 3.0e-09."
        ),
    ),
]


@pytest.mark.parametrize(("found", "sentence"), UNSURE)
def test_what_is_not_sure_of_a_motion_has_one_wording(
    found: RoundOff | Agreement, sentence: str
) -> None:
    assert found.sentence == sentence
