"""Accounts on toy discrepancies whose effects and interactions are known."""

import math
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.engines.base import ModelDifference
from harness.metrics.quantities import QUANTITIES, Number
from harness.studies.shared.ablation import AblationPath, Account, Closed, account, total
from models import load

NAMES = ("rim", "damping", "timestep")
PATH = AblationPath(
    scene=load("gentle-rock"),
    engine="toy",
    gaps=tuple(ModelDifference(name=name, settings=(), sentence="") for name in NAMES),
    settings=(),
    shipped_timestep=1e-3,
    matched_timestep=1e-3,
)


def toy_account(level: Callable[[Closed], Number]) -> Account:
    return account(PATH, QUANTITIES["turn_error_deg"], level)


def test_effects_that_add_are_the_same_in_any_company() -> None:
    effect = {"rim": 4.0, "damping": -1.0, "timestep": 0.5}
    found = toy_account(lambda closed: 10.0 - sum(effect[name] for name in closed))
    assert found.in_order == found.alone == found.left_open == (4.0, -1.0, 0.5)
    assert found.whole == 3.5
    assert found.remains == 6.5
    assert found.interaction == found.interaction_left_open == 0.0


def test_what_two_gaps_do_only_together_is_the_interaction() -> None:
    together = 2.0  # taken away only if both rim and damping are closed

    def level(closed: frozenset[str]) -> float:
        return 10.0 - len(closed) - together * ({"rim", "damping"} <= closed)

    found = toy_account(level)
    assert found.in_order == (1.0, 3.0, 1.0)
    assert found.alone == (1.0, 1.0, 1.0)
    assert found.left_open == (3.0, 3.0, 1.0)
    assert found.interaction == -together
    assert found.interaction_left_open == together


@given(st.lists(st.floats(-1e3, 1e3), min_size=8, max_size=8))
def test_the_path_sums_to_the_whole(levels: list[float]) -> None:
    found = toy_account(
        lambda closed: levels[sum(2**k for k, name in enumerate(NAMES) if name in closed)]
    )
    scale = max(map(abs, levels))
    assert found.whole is not None
    # three differences and their sum are rounded once each
    assert total(found.in_order) == pytest.approx(found.whole, rel=0, abs=8 * math.ulp(scale))


def test_an_unknown_level_leaves_unknown_only_what_rests_on_it() -> None:
    found = toy_account(lambda closed: None if closed == {"rim"} else float(len(closed)))
    assert found.in_order == (None, None, -1.0)
    assert found.alone == (None, -1.0, -1.0)
    assert found.left_open == (-1.0, -1.0, -1.0)
    assert found.whole == -3.0
    assert found.interaction is None
    assert found.interaction_left_open == 0.0
