"""Which effects a scene calls for: the design, the verdicts on real engines, the accounts."""

from dataclasses import replace

import pytest

from harness.core.errors import InvalidSettingError
from harness.core.report_model import Prose, Table
from harness.evaluation.run_cases import run_cases
from harness.studies.effects.changes import Effect, EffectsResults, EffectStatus
from harness.studies.effects.plan import FACTORS, HEIGHT, EffectsPlan, plan_effects
from harness.studies.effects.study import effects_report
from models.body_effects import Damping, Tilt
from models.catalogue import load
from models.contact_effects import Compliance, Drilling, Restitution, RoundedRim, Slip
from models.effects import KINDS, OPTIONAL_CONSTANTS, Effects
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
    assert added == [
        {name, name.partition(".")[0]} - {"slip"}
        for name in FACTORS
        if name not in {"slip", "tilt"}
    ]


def test_every_effect_each_optional_constant_and_the_height_are_factors() -> None:
    assert set(FACTORS) == {*KINDS, *OPTIONAL_CONSTANTS, HEIGHT}
    made = plan_effects(GENTLE, ("reference",))
    with_all = [case.scene for case in made.cases()]
    demanded = {name for scene in with_all for name in scene.effects.demanded()}
    assert demanded == {*KINDS, *OPTIONAL_CONSTANTS}
    assert {scene.release.height for scene in with_all} == {0.0, 1e-3}


def test_a_constant_comes_and_goes_with_its_effect() -> None:
    made = plan_effects(with_effects(slip=Slip(mu=0.4, patch=1e-3)), ("reference",))
    assert made.declared == {"slip", "slip.patch"}
    found = list(made.subsets())
    assert found[:3] == [{"slip", "slip.patch"}, set(), {"slip"}]
    assert {"slip.patch"} not in found
    assert made.scene_with(frozenset({"slip"})).effects == Effects(slip=Slip(mu=0.4))
    assert made.others("slip.patch") == (frozenset({"slip"}),)
    assert made.others("slip") == (frozenset(),)


def test_static_friction_is_assumed_above_the_kinetic_one_of_the_scene() -> None:
    made = plan_effects(with_effects(slip=Slip(mu=0.2)), ("reference",))
    law = made.law("slip", frozenset({"slip", "slip.mu_static"}))
    assert law == Slip(mu=0.2, mu_static=0.25)


@pytest.mark.parametrize("exponent", [1.0, 1.25, 2.0])
def test_another_exponent_is_as_deep_and_as_damped_under_the_weight(exponent: float) -> None:
    law = Compliance(stiffness=3e5, damping=40.0, exponent=exponent)
    scene = with_effects(compliance=law)
    made = plan_effects(scene, ("reference",), words=(("compliance.exponent", 1.5),))
    own, other = frozenset({"compliance"}), frozenset({"compliance", "compliance.exponent"})
    assert scene.effects.compliance == made.law("compliance", own if exponent == 1.0 else other)
    weight, found = scene.can.mass * scene.gravity, made.law("compliance", own)
    if exponent == 1.0:
        found = made.law("compliance", other)
        assert found.exponent == 1.5
    depth = (weight / law.stiffness) ** (1.0 / exponent)
    # a power and its inverse: some roundings
    assert found.stiffness * depth**found.exponent == pytest.approx(weight, rel=1e-12)
    had, has = (
        each.damping * (1.0 if each.linear else depth**each.exponent) for each in (law, found)
    )
    assert has == pytest.approx(had, rel=1e-12)


def test_a_drop_needs_a_contact_that_can_be_left() -> None:
    height = replace(BRIEF, release=replace(BRIEF.release, height=1e-3))
    made = plan_effects(height, ("pybullet",), timestep=COARSE)
    assert made.declared == {HEIGHT}
    found = of(studied(made), "pybullet", HEIGHT)
    assert found.declared
    assert found.strength == "height = 0.001"
    assert found.run is not None
    assert found.run.case.scene.release.height == 1e-3


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
    assert len(found) == 2 + 2 * 4 + len(FACTORS) - 4


@pytest.mark.parametrize(
    ("word", "refused", "allowed"),
    [
        (("slide.mu", 0.3), "slide.mu", "slip, compliance"),
        (("slip.nu", 0.3), "slip.nu", "slip.mu"),
        (("slip.mu", -0.3), "slip.mu=-0.3", "zero or greater"),
        (("slip.mu_static", 0.3), "slip.mu_static=0.3", "at least `mu`"),
        (("restitution.coefficient", 1.5), "restitution.coefficient=1.5", "from 0 to 1"),
        (("restitution.law", 1.0), "restitution.law=1.0", "'newton' or 'poisson'"),
        (("compliance.stiffness", 0.0), "compliance.stiffness=0.0", "greater than zero"),
        (("height", 0.0), "height=0.0", "greater than zero"),
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
    patch = of(found, "mujoco", "slip.patch")
    assert patch.verdict is EffectStatus.UNSUPPORTED
    assert patch.why == "mujoco cannot represent slip.patch."
    assert of(found, "reference", "slip.patch").run is not None
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
            {"slip.patch", "drilling", "rolling_resistance", "contour_friction"},
            marks=pytest.mark.slow,
        ),
        (
            {"compliance": Compliance(stiffness=1e5, damping=10.0)},
            {"restitution", "restitution.law"},
        ),
        (
            {"restitution": Restitution(coefficient=0.5)},
            {"compliance", "compliance.exponent"},
        ),
        pytest.param({"slip": Slip(mu=0.3)}, set(), marks=pytest.mark.slow),
    ],
)
def test_an_effect_that_contradicts_the_scene_is_said_to(
    declared: dict[str, object], contradicted: set[str]
) -> None:
    found = studied(plan_effects(with_effects(BRIEF, **declared), ("reference",))).effects
    of_kind = [one for one in found if one.verdict is EffectStatus.CONTRADICTED]
    assert {one.name for one in of_kind} == contradicted
    assert all(one.run is None and not one.changes and not one.declared for one in of_kind)
    assert all("beside" in one.why or "without friction" in one.why for one in of_kind)


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
    assert list(effects.index) == list(FACTORS)
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
    others = (name for name in FACTORS if name != "compliance")
    assert verdicts == dict.fromkeys(others, EffectStatus.UNSUPPORTED)
