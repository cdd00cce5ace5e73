"""Model parity where a scene declares effects: read back or probed, equal, and able to fail."""

import math
from dataclasses import replace
from typing import Any

import pytest

from harness.core.case import Case, Value
from harness.core.errors import RefusedModelError
from harness.core.simulation import ParityRow
from harness.engines.registry import engine
from models import Drilling, Effects, RollingResistance, Scene
from tests.support.declared_effects import EFFECTS, declaring
from tests.support.engines import DOUBLE, INSTALLED, imposed, stepping_engine

PROBED = {
    "slip": {"friction of the pair": 0.3},
    "compliance": {"contact stiffness": 2e4, "contact damping": 5.0},
    "restitution": {"restitution": 0.5},
    "drilling": {"arm of drilling": 1e-3},
    "rolling_resistance": {"arm of rolling resistance": 5e-4},
    "damping": {"linear damping": 0.5, "angular damping": 0.3},
    "rim": {"radius of the rim's arc": 2e-3},
    "tilt": {"gravity": 9.81 * math.cos(0.1), "gravity along y": 9.81 * math.sin(0.1)},
    "shake": {
        "horizontal shaking": 5e-4,
        "vertical shaking": 3e-4,
        "misfit of the shaking": 0.0,
    },
    "point_mass": {"mass": 0.086, "centre of mass x": 0.01, "centre of mass z": -0.005},
}
"""What is read back or probed of each effect, as declared."""

ENGINES = INSTALLED


def honouring(effect: str) -> list[tuple[str, str]]:
    """Return the engines that honour an effect, each with it."""
    return [(name, effect) for name in ENGINES if effect in engine(name).capabilities.honours]


def carrying(*effects: str) -> list[str]:
    """Return the engines that honour all of these effects."""
    return [name for name in ENGINES if engine(name).capabilities.honours.issuperset(effects)]


def case_of(scene: Scene, name: str, timestep: float = 1e-4, **options: Value) -> Case:
    return Case(scene=scene, engine=name, timestep=timestep, options=tuple(options.items()))


def rows(scene: Scene, name: str, timestep: float = 1e-4, **options: Value) -> dict[str, ParityRow]:
    case = case_of(scene, name, timestep, **options)
    return {row.quantity: row for row in stepping_engine(name).parity(case)}


@pytest.mark.parametrize("timestep", [1e-3, 1e-4, 1e-6])
@pytest.mark.parametrize(
    ("name", "effect"),
    [pair for effect in PROBED for pair in honouring(effect)],
)
def test_what_an_engine_honours_is_equal(
    gentle: Scene, name: str, effect: str, timestep: float
) -> None:
    scene = declaring(gentle, effect)
    found = rows(scene, name, timestep)
    told = {"equal", "does not apply"}
    differing = {row.quantity for row in found.values() if row.verdict not in told}
    assert differing <= imposed(case_of(scene, name, timestep))
    assert "mismatch" not in {row.verdict for row in found.values()}
    for quantity, declared in PROBED[effect].items():
        assert found[quantity].declared == pytest.approx(declared, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("timestep", [1e-2, 2e-3, 1e-3, 1e-4])
@pytest.mark.parametrize("length", [1e-5, 1e-4, 1e-3])
@pytest.mark.parametrize(
    ("name", "effect"),
    [
        pair
        for effect in ("drilling", "rolling_resistance")
        for pair in honouring(effect)
        if pair[0] in DOUBLE
    ],
)
def test_an_arm_is_found_at_any_timestep_however_short_it_is(
    gentle: Scene, name: str, effect: str, length: float, timestep: float
) -> None:
    kind: Any = {"drilling": Drilling, "rolling_resistance": RollingResistance}[effect]
    declared = {effect: kind(length=length)}
    scene = replace(gentle, effects=Effects(**declared))
    arm = rows(scene, name, timestep)[f"arm of {effect.replace('_', ' ')}"]
    assert arm.verdict == "equal"
    # a hundredth up to a millisecond; a step of ten is a sixth of the natural time
    assert arm.found == pytest.approx(length, rel=0.01 if timestep <= 2e-3 else 0.1)


@pytest.mark.parametrize("name", carrying("tilt", "shake", "point_mass", "slip"))
def test_effects_that_do_not_meet_are_equal_together(gentle: Scene, name: str) -> None:
    both = declaring(gentle, "tilt", "shake", "point_mass", "slip")
    differing = {row.quantity for row in rows(both, name).values() if row.verdict != "equal"}
    assert differing <= imposed(case_of(both, name))


def test_only_pybullet_has_an_arc() -> None:
    honoured = engine("pybullet").capabilities.honours
    assert honoured - engine("mujoco").capabilities.honours == {"rim"}
    assert honoured == set(PROBED)


@pytest.mark.parametrize(
    ("effect", "name", "options", "quantities"),
    [
        (
            "compliance",
            "mujoco",
            {"solref": (0.02, 1.0)},
            {"contact stiffness", "friction of the pair", "friction between the axes"},
        ),
        ("drilling", "mujoco", {"condim": 3}, {"arm of drilling"}),
        ("rolling_resistance", "mujoco", {"condim": 4}, {"arm of rolling resistance"}),
        ("damping", "pybullet", {"linearDamping": 0.0}, {"linear damping", "speed kept"}),
        ("damping", "pybullet", {"angularDamping": 0.1}, {"angular damping", "spin kept"}),
        ("restitution", "pybullet", {"contactERP": 0.8}, {"restitution"}),
        ("restitution", "mujoco", {"solref": (2e-4, 1.0)}, {"restitution"}),
        ("restitution", "mujoco", {"integrator": "RK4"}, {"restitution"}),
        (
            "rim",
            "pybullet",
            {"collisionMargin": 0.0},
            {"rim deviation", "radius of the rim's arc"},
        ),
    ],
)
def test_an_effect_that_an_option_spoils_is_a_mismatch(
    gentle: Scene, effect: str, name: str, options: dict[str, Any], quantities: set[str]
) -> None:
    found = rows(declaring(gentle, effect), name, **options)
    assert {row.quantity for row in found.values() if row.verdict != "equal"} == quantities


@pytest.mark.parametrize("name", carrying("tilt", "shake", "point_mass"))
def test_an_engine_with_another_scenes_gravity_or_mass_is_a_mismatch(
    gentle: Scene, name: str
) -> None:
    from harness.engines.parity.checks import parity  # noqa: PLC0415 - of this test alone

    scene = declaring(gentle, "tilt", "shake", "point_mass")
    case = Case(scene=scene, engine=name, timestep=1e-4)
    for other, quantities in (
        (replace(EFFECTS["tilt"], direction=0.0), {"gravity along x", "gravity along y"}),
        (replace(EFFECTS["shake"], frequency=15.01), {"misfit of the shaking"}),
        (replace(EFFECTS["shake"], phase=0.41), {"misfit of the shaking", "vertical shaking"}),
        (replace(EFFECTS["point_mass"], y=0.006), {"centre of mass y", "inertia xy"}),
    ):
        changed = {key: other for key, kind in EFFECTS.items() if type(kind) is type(other)}
        wrong = replace(scene, effects=replace(scene.effects, **changed))
        table = parity(stepping_engine(name).open(case), wrong, 1e-4, {})
        differing = {row.quantity for row in table if row.verdict != "equal"}
        assert quantities <= differing, changed


@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_what_an_engine_cannot_carry_together_is_refused(gentle: Scene, name: str) -> None:
    case = Case(scene=declaring(gentle, "damping", "point_mass"), engine=name)
    with pytest.raises(RefusedModelError) as caught:
        stepping_engine(name).open(case)
    assert (caught.value.engine, caught.value.case) == (name, case.label())
    assert "the reference carries both" in caught.value.reason
