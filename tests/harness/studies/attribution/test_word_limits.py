"""Numbers that docstrings cite of the words on an attribution, just inside and just outside each.

They are written out here and not imported: whoever changes one in the code is told.
"""

import pytest

from harness.metrics.quantities import Quantity
from harness.studies.attribution.study import ATTRIBUTED
from harness.studies.shared.ablation import AblationPath, ablation_path, account
from models import Scene

TURN: Quantity = ATTRIBUTED[0]


@pytest.fixture(scope="module")
def path(gentle: Scene) -> AblationPath:
    return ablation_path(gentle, "mujoco")


@pytest.mark.parametrize(("share", "nothing"), [(0.99e-6, True), (1.01e-6, False)])
def test_a_millionth_of_the_largest_discrepancy_is_nothing(
    path: AblationPath, share: float, *, nothing: bool
) -> None:
    first, *others = path.names
    found = account(
        path,
        TURN,
        lambda closed: -5.0 + 5.0 * share * (first in closed) + len(closed & set(others)),
    )
    # the largest is as shipped, -5
    said = found.in_order_sentence()
    assert (f"{first} nothing" in said) is nothing


@pytest.mark.parametrize(("share", "hardly"), [(0.0099, True), (0.0101, False)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_gaps_hardly_interact_within_a_hundredth_of_the_whole(
    path: AblationPath, share: float, sign: float, *, hardly: bool
) -> None:
    count = len(path.names)

    def level(closed: frozenset[str]) -> float:
        # what closing all of them takes away beside one each
        together = sign * share * count / (1.0 - sign * share)
        return 10.0 - len(closed) - together * (len(closed) == count)

    found = account(path, TURN, level)
    assert found.whole is not None
    assert found.interaction is not None
    assert abs(found.interaction / found.whole) == pytest.approx(share)
    said = found.interaction_sentence()
    assert ("the whole to within 1%, so that they hardly interact" in said) is hardly
