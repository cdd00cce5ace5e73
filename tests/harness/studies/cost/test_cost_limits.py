"""Numbers that the cost page cites of its prices and scenes, just inside and just outside each.

They are written out here as README and the docstrings have them, and not imported: whoever changes
one in the code is told which sentence no longer holds.
"""

import math
from collections.abc import Sequence
from types import SimpleNamespace

import pytest

from harness.core.case import Case
from harness.core.simulation import Outcome
from harness.engines.base import Variant
from harness.studies.cost import design, points, tables
from harness.studies.cost.points import Family, Point, timesteps
from harness.studies.cost.prices import FIXED, TARGETS, Offer, cost, exponent, offers, price
from models import Scene, load

GENTLE = load("gentle-rock")
TURN = "turn_deg"


def measured(error: float) -> dict[str, object]:
    """Return what is kept of a run of a second with this error of the turn, deg."""
    return {
        "outcome": Outcome.FINISHED.name,
        "timestep_s": 1e-3,
        "errors": {TURN: error},
        "simulated_s": 1.0,
    }


def point(error: float, *seconds: float, timestep: float = 1e-3) -> Point:
    """Return a point with this error, deg, and these repeats of its time, processor seconds."""
    return Point(
        case=Case(scene=GENTLE, engine="mujoco", timestep=timestep),
        variant=Variant(name="one"),
        run=measured(error) | {"timestep_s": timestep},
        timed={"cpu_s": list(seconds)},
    )


def test_prices_are_of_a_degree_a_tenth_and_a_hundredth() -> None:
    assert TARGETS == (1.0, 0.1, 0.01)


@pytest.mark.parametrize(("dearer", "tied"), [(1.209, True), (1.211, False)])
def test_a_minimum_of_repeats_is_uncertain_by_a_tenth_at_least(
    dearer: float, *, tied: bool
) -> None:
    # of both: the one may be a tenth less than it should, the other a tenth more
    sold = [Offer(point=point(0.1, seconds, seconds), error=0.1) for seconds in (1.0, dearer)]
    assert len(price(sold, 1.0).winners) == 1 + tied


@pytest.mark.parametrize(
    ("second", "noise"), [(1.05, 0.1), (1.3, 0.3), (1.49, 0.49), (1.51, 0.5), (4.0, 0.5)]
)
def test_a_repeat_that_takes_half_as_long_again_was_disturbed(second: float, noise: float) -> None:
    assert Offer(point=point(0.1, second, 9.0, 1.0), error=0.1).noise == pytest.approx(noise)


def test_the_finest_rung_is_brought_down_at_second_order_at_most() -> None:
    ladder = [point(1.0, 1.0, timestep=3e-4), point(1e-9, 3.0, timestep=1e-4)]
    assert offers(ladder, TURN, steps=True)[-1].error == pytest.approx(1.0 / 9.0)


def tuned(*families: tuple[str, float, float]) -> str:
    """Return which of these, each a name, an error in degrees and a cost, is tuned to."""
    own, errors, times = [], {}, {}
    for number, (name, error, seconds) in enumerate(families):
        case = Case(scene=GENTLE, engine="mujoco", timestep=1e-3 / (number + 1))
        own.append(Family(variant=Variant(name=name), cases=(case,)))
        errors[case] = measured(error)
        times[case] = {"cpu_s": [seconds] * 3}
    plan = SimpleNamespace(
        engines=("mujoco",), tuning=own, tuning_scene=GENTLE, target=TURN, scored=(), hardness=()
    )
    return cost(plan, errors, times, {}).tuned["mujoco", FIXED]  # type: ignore[arg-type]


@pytest.mark.parametrize(("dearer", "chosen"), [(1.249, "first"), (1.251, "second")])
def test_of_costs_within_a_quarter_the_first_declared_is_taken(dearer: float, chosen: str) -> None:
    assert tuned(("first", 0.05, dearer), ("second", 0.05, 1.0)) == chosen


@pytest.mark.parametrize(
    ("errors", "chosen"),
    [
        ((0.099, 0.101), "dear"),
        ((0.101, 0.101), "cheap"),  # none reaches a tenth, and both a degree
        ((0.8, 0.999), "cheap"),
        ((0.999, 1.001), "dear"),
        ((1.3, 1.001), "cheap"),  # none reaches a degree: the nearest
        ((1.001, 1.3), "dear"),
    ],
)
def test_settings_are_tuned_to_a_tenth_of_a_degree_and_failing_that_to_one(
    errors: Sequence[float], chosen: str
) -> None:
    dear, cheap = errors
    assert tuned(("dear", dear, 10.0), ("cheap", cheap, 1.0)) == chosen


@pytest.mark.parametrize(("share", "own"), [(0.499, True), (0.501, False)])
def test_a_plateau_is_shared_with_matched_from_half_of_it_on(share: float, *, own: bool) -> None:
    def family(name: str, **settings: float) -> Family:
        variant = Variant(name=name, settings=tuple(settings.items()), imposes="a level")
        return Family(variant=variant, cases=(Case(scene=GENTLE, engine="mujoco"),))

    found = SimpleNamespace(
        plan=SimpleNamespace(paths=()),
        ladders=((family("matched"), (point(0.2 * share, 1.0),)),),
    )
    levelled = family("levelled", margin=1.0)
    # the sentence of a row, without the study that it comes from
    cause = tables._cause(found, levelled, TURN, 0.2)  # type: ignore[arg-type]  # noqa: SLF001
    assert cause.startswith("levelled: a level" if own else "Shared with matched")


def scene_with(rate: float, monkeypatch: pytest.MonkeyPatch) -> Scene:
    """Return a scene whose contact point goes round at this rate, rad/s."""
    bounce = SimpleNamespace(peak_psi_dot=-rate)
    monkeypatch.setattr(points, "truth", lambda _: SimpleNamespace(bounces=(bounce,)))
    return GENTLE


@pytest.mark.parametrize(("share", "coarsest"), [(0.99, 1e-4), (1.01, 1e-5)])
def test_the_coarsest_step_is_the_power_of_ten_next_to_five_radians_of_precession(
    share: float, coarsest: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = scene_with(share * 5.0 * 10.0**4.5, monkeypatch)
    assert timesteps(scene, "quick") == pytest.approx(
        [coarsest * share for share in (1.0, 0.3, 0.1, 0.03, 0.01)], rel=1e-12, abs=0
    )
    full = timesteps(scene, "full")
    assert (full[0], full[-1], len(full)) == pytest.approx(
        (coarsest, 1e-3 * coarsest, 10), rel=1e-12, abs=0
    )
    assert timesteps(scene, "tuning")[-1] == pytest.approx(0.03 * coarsest, rel=1e-12, abs=0)


@pytest.mark.parametrize("rate", [0.0, 1e-3])
def test_no_step_is_longer_than_a_millisecond(rate: float, monkeypatch: pytest.MonkeyPatch) -> None:
    assert timesteps(scene_with(rate, monkeypatch), "quick")[0] == 1e-3


@pytest.mark.parametrize(("off", "near"), [(1.0199, True), (1.0201, False), (0.9801, True)])
def test_a_scene_misses_the_epsilon_asked_for_by_a_fiftieth_at_most(
    off: float, monkeypatch: pytest.MonkeyPatch, *, near: bool
) -> None:
    tried: list[Scene] = []

    def same(scene: Scene) -> float:
        tried.append(scene)
        return off * 1e-7

    monkeypatch.setattr(design, "epsilon", same)
    found = design.hardened(GENTLE, 1e-7)
    assert (found is not None) is near
    # the scene itself, and six rounds where none comes near enough
    assert len(tried) == (2 if near else 7)


def test_an_exponent_has_an_interval_of_95_percent() -> None:
    # three points about a line, residuals d, -2 d, d in logarithms: one degree of freedom, for
    # which the table of Student's t has 12.706
    off = 0.1
    costs = [math.exp(-x + off * sign) for x, sign in zip((0, 1, 2), (1.0, -2.0, 1.0), strict=True)]
    found = exponent([math.exp(x) for x in (0, 1, 2)], costs)
    assert found is not None
    assert found.exponent == pytest.approx(-1.0)
    assert found.confidence == pytest.approx(12.706 * off * math.sqrt(6.0 / 2.0), rel=1e-4)
