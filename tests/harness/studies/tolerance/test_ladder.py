"""Verdicts on ladders of known slope, level and factor."""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from harness.core.verdict import Status
from harness.engines.base import Variant
from harness.studies.tolerance.delivered import PULLS
from harness.studies.tolerance.design import Knob
from harness.studies.tolerance.ladder import Honesty, ToleranceLadder
from models import load

ASKED = tuple(10.0**-power for power in range(2, 13))


def ladder(error: Callable[[float], float | None], reason: str = "it fell") -> ToleranceLadder:
    """Return a ladder whose error is a function of what is asked for."""
    values = {asked: error(asked) for asked in ASKED}
    return ToleranceLadder(
        knob=Knob(engine="reference", variant=Variant(name="one", along="rtol")),
        scene=load("gentle-rock"),
        measure="angle of turn",
        floor=1e-14,
        records={
            asked: {"error": value, "reason": "" if value is not None else reason}
            for asked, value in values.items()
        },
    )


@pytest.mark.parametrize(
    ("error", "kind"),
    [
        (lambda asked: 3.0 * asked, Honesty.HONEST),
        (lambda asked: 10.1 * asked, Honesty.OPTIMISTIC),
        (lambda asked: 9.9 * asked, Honesty.HONEST),
        (lambda asked: 9e-3 * asked, Honesty.CAUTIOUS),
        (lambda asked: 3.0 * asked + 1e-8, Honesty.SATURATES),
        (lambda _: 1e-3, Honesty.IDLE),
        (lambda _: 5e-15, Honesty.ROUND_OFF),
        # above round-off, and no more than honest at the finest value
        (lambda _: 5e-12, Honesty.CAUTIOUS),
        (lambda _: 1.1e-11, Honesty.IDLE),
        # at the coarsest value the error crosses zero; finer ones follow what is asked
        (lambda asked: asked if asked < 5e-3 else 3e-12, Honesty.HONEST),
        (lambda asked: None if asked > 5e-3 else asked, Honesty.LOST),
        (lambda _: None, Honesty.LOST),
    ],
)
def test_each_kind_of_verdict(error: Callable[[float], float | None], kind: Honesty) -> None:
    judged = ladder(error)
    assert judged.honesty is kind
    assert judged.verdict.text.startswith(f"{kind.value}: ")


def test_slope_factor_and_level_are_those_that_were_put_in() -> None:
    judged = ladder(lambda asked: 0.2 * asked**0.8 + 2e-9)
    assert judged.saturation is not None
    start, level = judged.saturation
    assert 1e-10 <= start <= 1e-9
    assert level == pytest.approx(2e-9, rel=0.5, abs=0)  # of the rungs before, some is still there
    assert judged.slope == pytest.approx(0.8, rel=0.05, abs=0)
    steep = ladder(lambda asked: 0.2 * asked**0.8)
    assert steep.worst == pytest.approx((0.2 * 1e-12**-0.2, 1e-12))


def test_what_no_contact_can_follow_is_not_judged() -> None:
    judged = ladder(lambda _: None, PULLS)
    assert judged.honesty is Honesty.UNJUDGED
    assert judged.verdict.status is Status.NOT_MEASURED
    assert judged.worst is None
    assert judged.slope is None


def test_an_error_that_hardly_falls_over_two_decades_does_not_follow() -> None:
    errors = {1e-2: 1e-3, 1e-3: 5e-4, 1e-4: 3e-4}
    judged = ladder(errors.get)
    known = {asked: judged.records[asked] for asked in ASKED if asked > 5e-5}
    flat = replace(judged, records=known)
    assert flat.honesty is Honesty.ERRATIC
    assert flat.slope == pytest.approx(math.log10(1e-3 / 3e-4) / 2.0, rel=0.01, abs=0)
    assert flat.verdict.status is Status.DEVIATES
