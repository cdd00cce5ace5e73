"""Which scenes have an exact motion: all that the reference carries, but no chaotic one."""

from dataclasses import replace

import pytest

from harness.core.errors import InvalidSettingError
from harness.engines.reference import assumption_checks
from harness.engines.reference.assumption_checks import Divergence, check_exact
from harness.studies.cost.design import plan_cost
from models import Compliance, Effects, Horizon, Restitution, Scene, Slip, Tilt, load


@pytest.mark.parametrize(
    "effects",
    [
        Effects(),
        Effects(slip=Slip(mu=0.3)),
        Effects(compliance=Compliance(stiffness=1e4, exponent=1.5)),
        Effects(restitution=Restitution(coefficient=0.5)),
    ],
)
def test_what_the_reference_carries_is_accepted(brief: Scene, effects: Effects) -> None:
    check_exact(replace(brief, effects=effects))


def test_what_it_does_not_is_refused(brief: Scene) -> None:
    beyond = (
        replace(brief, gravity=0.0),
        replace(brief, release=replace(brief.release, height=-1e-3)),
    )
    for scene in beyond:
        with pytest.raises(InvalidSettingError) as caught:
            check_exact(scene)
        assert (caught.value.name, caught.value.value) == ("SCENE", scene.name)
        assert "gravity with no effects but" in caught.value.allowed


@pytest.mark.parametrize("chaotic", [False, True])
def test_a_chaotic_one_is_refused(
    brief: Scene, monkeypatch: pytest.MonkeyPatch, *, chaotic: bool
) -> None:
    # the search for chaos itself is tested where it is made; of twenty bounces it takes seconds
    found = Divergence(growth=1e9, lyapunov_time=0.4, parted=5.0, chaotic=chaotic)
    monkeypatch.setattr(assumption_checks, "divergence_of", lambda _: found)
    tilted = replace(brief, effects=Effects(tilt=Tilt(angle=0.1)))
    if not chaotic:
        check_exact(tilted)
        return
    with pytest.raises(InvalidSettingError) as caught:
        check_exact(tilted)
    assert "not chaotic" in caught.value.allowed


def test_the_price_of_a_scene_that_slips_asks_no_model_that_knows_no_slip(brief: Scene) -> None:
    slipping = replace(load("slipping-rock"), horizon=Horizon(seconds=0.02))
    ideal = replace(brief, release=replace(brief.release, phi=0.3))
    made = plan_cost(slipping, ideal, ["reference", "pybullet"])
    assert made.engines == ("pybullet",)
    assert plan_cost(ideal, slipping, ["reference", "pybullet"]).engines == (
        "reference",
        "pybullet",
    )
