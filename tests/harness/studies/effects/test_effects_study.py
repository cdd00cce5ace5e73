"""Which effects a scene calls for: the design, the verdicts on real engines, the accounts."""

from dataclasses import replace

import pytest

from harness.core.errors import InvalidSettingError
from harness.core.report_model import Prose, Table
from harness.evaluation.run_cases import run_cases
from harness.studies.effects.changes import Effect, EffectsResults, EffectStatus
from harness.studies.effects.plan import EffectsPlan, plan_effects
from harness.studies.effects.study import effects_report
from models.body_effects import Damping, Tilt
from models.catalogue import load
from models.contact_effects import Compliance, Drilling, Restitution, RoundedRim, Slip
from models.effects import KINDS, Effects
from models.scene import Horizon, Scene
from tests.support.figures import assert_two_sentences

GENTLE = load("gentle-rock")
BRIEF = replace(GENTLE, horizon=Horizon(seconds=0.02))
"""For verdicts that rest on what can be run, and not on what it does."""
COARSE = 1e-3


def with_effects(scene: Scene = GENTLE, **declared: object) -> Scene:
    return replace(scene, effects=Effects(**declared))  # type: ignore[arg-type]


def studied(made: EffectsPlan) -> EffectsResults:
    cases = made.cases()
    evaluations = dict(zip(cases, run_cases(cases), strict=True))
    return EffectsResults(plan=made, evaluations=evaluations, times={})


def of(found: EffectsResults, engine: str, name: str) -> Effect:
    return next(one for one in found.effects if (one.engine, one.name) == (engine, name))


def test_every_subset_of_few_effects_is_run_and_each_other_effect_once() -> None:
    scene = with_effects(slip=Slip(mu=0.3), tilt=Tilt(angle=0.01))
    found = list(plan_effects(scene, ("mujoco",)).subsets())
    assert found[0] == {"slip", "tilt"}
    assert set(found[1:4]) == {frozenset(), frozenset({"slip"}), frozenset({"tilt"})}
    added = [subset - {"slip", "tilt"} for subset in found[4:]]
    assert added == [{name} for name in KINDS if name not in {"slip", "tilt"}]


def test_many_effects_are_varied_one_at_a_time_from_both_ends() -> None:
    scene = with_effects(
        slip=Slip(mu=0.3),
        tilt=Tilt(angle=0.01),
        drilling=Drilling(length=1e-4),
        damping=Damping(linear=0.1),
    )
    made = plan_effects(scene, ("mujoco",))
    own = made.declared
    found = list(made.subsets())
    assert not made.factorial
    assert frozenset() in found
    assert all({name} in found and own - {name} in found for name in own)
    assert len(found) == 2 + 2 * 4 + len(KINDS) - 4


@pytest.mark.parametrize(
    ("word", "refused", "allowed"),
    [
        (("slide.mu", 0.3), "slide.mu", "slip, compliance"),
        (("slip.nu", 0.3), "slip.nu", "slip.mu"),
        (("slip.mu", -0.3), "slip.mu=-0.3", "zero or greater"),
    ],
)
def test_an_assumption_that_makes_no_sense_is_refused(
    word: tuple[str, float], refused: str, allowed: str
) -> None:
    with pytest.raises(InvalidSettingError) as caught:
        plan_effects(GENTLE, ("mujoco",), words=(word,))
    assert (caught.value.name, caught.value.value) == ("--assume", refused)
    assert allowed in caught.value.allowed


@pytest.mark.slow
def test_a_slippery_plane_is_missing_where_the_rim_would_slip_and_else_harmless() -> None:
    slippery = plan_effects(GENTLE, ("reference",), words=(("slip.mu", 0.1),))
    assert of(studied(slippery), "reference", "slip").verdict is EffectStatus.MISSING
    rough = plan_effects(GENTLE, ("reference",), words=(("slip.mu", 5.0),))
    found = of(studied(rough), "reference", "slip")
    assert found.verdict is EffectStatus.HARMLESS
    # the rim sticks all the way, so that the two models solve one motion to their tolerances
    assert abs(found.changes["turn_deg"] or 0.0) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mu", "verdict"),
    [
        (0.1, EffectStatus.NEEDED),
        pytest.param(5.0, EffectStatus.HARMLESS, marks=pytest.mark.slow),
    ],
)
def test_a_declared_effect_is_needed_if_the_outcome_rests_on_it(
    mu: float, verdict: EffectStatus
) -> None:
    made = plan_effects(with_effects(slip=Slip(mu=mu)), ("reference",))
    assert of(studied(made), "reference", "slip").verdict is verdict


def test_what_an_engine_adds_to_every_scene_cannot_be_removed() -> None:
    found = studied(plan_effects(BRIEF, ("reference", "mujoco"), timestep=COARSE))
    assert of(found, "reference", "restitution").verdict is EffectStatus.UNSUPPORTED
    (imposed,) = [one for one in found.effects if one.verdict is EffectStatus.IMPOSED]
    assert (imposed.engine, imposed.name) == ("mujoco", "compliance")
    assert imposed.why.startswith("It cannot be removed: ")
    assert not imposed.changes
    assert imposed.run is None


@pytest.mark.parametrize(
    ("declared", "contradicted"),
    [
        pytest.param(
            {"slip": Slip(mu=0.0)},
            {"drilling", "rolling_resistance", "contour_friction"},
            marks=pytest.mark.slow,
        ),
        ({"compliance": Compliance(stiffness=1e5, damping=10.0)}, {"restitution"}),
        ({"restitution": Restitution(coefficient=0.5)}, {"compliance"}),
        pytest.param({"slip": Slip(mu=0.3)}, set(), marks=pytest.mark.slow),
    ],
)
def test_an_effect_that_contradicts_the_scene_is_said_to(
    declared: dict[str, object], contradicted: set[str]
) -> None:
    # of the engines that come with the package the one that can represent each of these effects
    made = plan_effects(with_effects(BRIEF, **declared), ("pybullet",), timestep=COARSE)
    found = studied(made).effects
    of_kind = [one for one in found if one.verdict is EffectStatus.CONTRADICTED]
    assert {one.name for one in of_kind} == contradicted
    assert all(one.run is None and not one.changes and not one.declared for one in of_kind)


@pytest.mark.slow
def test_the_changes_of_two_factors_add_up() -> None:
    scene = with_effects(slip=Slip(mu=0.2), tilt=Tilt(angle=0.02))
    found = studied(plan_effects(scene, ("mujoco",), timestep=COARSE))
    slip, tilt = of(found, "mujoco", "slip"), of(found, "mujoco", "tilt")
    for key in ("turn_deg", "bounce_time_s", "x_end_m"):
        first, last = slip.alone[key], tilt.changes[key]
        other, end = tilt.alone[key], slip.changes[key]
        assert first is not None
        assert last is not None
        assert other is not None
        assert end is not None
        # from ideal to declared, whichever comes first; sums of doubles of like size
        assert first + last == pytest.approx(other + end, abs=1e-9)
        assert slip.mean[key] == pytest.approx((first + end) / 2.0, abs=1e-9)


@pytest.mark.slow
def test_the_artefacts_name_every_effect_and_every_column() -> None:
    made = plan_effects(with_effects(slip=Slip(mu=0.2)), ("mujoco",), timestep=COARSE)
    artefacts = effects_report(studied(made))
    assert_two_sentences(artefacts)
    tables = {one.name: one for one in artefacts if isinstance(one, Table)}
    assert set(tables) == {f"gentle-rock-{name}" for name in ("effects", "factors", "runs")}
    for table in tables.values():
        assert set(table.columns) == set(table.frame.columns)
    effects = tables["gentle-rock-effects"].frame.set_index("effect")
    assert list(effects.index) == list(KINDS)
    assert effects["strength"]["slip"] == "mu = 0.2"
    words = next(one.text for one in artefacts if isinstance(one, Prose))
    assert "slip is needed" in words


def test_only_constants_of_an_effect_can_be_assumed() -> None:
    with pytest.raises(InvalidSettingError) as caught:
        plan_effects(GENTLE, ("mujoco",), timestep=COARSE, words=(("slip.modelling_choice", 1.0),))
    assert (caught.value.value, caught.value.allowed) == (
        "slip.modelling_choice",
        "slip.mu, slip.mu_static, slip.patch",
    )


def test_an_engine_that_cannot_carry_the_scene_says_so_of_every_effect() -> None:
    made = plan_effects(
        with_effects(BRIEF, rim=RoundedRim(radius=0.01)), ("mujoco",), timestep=COARSE
    )
    (without,) = made.cases()
    assert without.scene.effects.declared() == ()
    verdicts = {one.name: one.verdict for one in studied(made).effects}
    assert verdicts.pop("compliance") is EffectStatus.IMPOSED
    assert verdicts == dict.fromkeys(
        (name for name in KINDS if name != "compliance"), EffectStatus.UNSUPPORTED
    )
