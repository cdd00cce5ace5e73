"""Model parity of both engines: equal where matched, owned up to where shipped, fatal elsewhere."""

from dataclasses import replace
from typing import Any

import pytest

from harness.core.case import Case, Value
from harness.core.simulation import Outcome, ParityRow
from models import Can, Effects, Scene, Slip, load
from tests.support.engines import stepping_engine
from tests.support.evaluations import evaluated

ENGINES = ("mujoco", "pybullet")
CANS = {
    "paper": Can.from_groups(mass=0.043, radius=0.037, a=0.727, c=0.615, h=1.473),
    "flat heavy disk": Can.from_groups(mass=2.0, radius=0.2, a=0.27, c=0.5, h=0.1),
    "tall light tube": Can.from_groups(mass=0.004, radius=0.01, a=5.0, c=0.9, h=3.5),
}


def differing(rows: tuple[ParityRow, ...]) -> dict[str, Any]:
    """Return the verdict of each quantity that is not equal."""
    return {row.quantity: row.verdict for row in rows if row.verdict != "equal"}


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize("scene", ["gentle-rock", "paper-release", "steady-rolling", "wobble"])
def test_matched_engines_have_the_can_of_the_scene(name: str, scene: str) -> None:
    rows = stepping_engine(name).parity(Case(scene=load(scene), engine=name))
    assert differing(rows) == {}
    assert {row.quantity for row in rows} == {
        "mass",
        "transverse inertia A",
        "inertia asymmetry",
        "axial inertia C",
        "timestep",
        "gravity",
        "linear damping",
        "angular damping",
        "speed kept",
        "spin kept",
        "radius R",
        "half height H",
        "rim deviation",
        "friction of the pair",
    }


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize("can", CANS)
@pytest.mark.parametrize("timestep", [1e-3, 1e-6])
def test_matched_engines_have_any_can_at_any_timestep(
    gentle: Scene, name: str, can: str, timestep: float
) -> None:
    scene = replace(gentle, can=CANS[can])
    rows = stepping_engine(name).parity(Case(scene=scene, engine=name, timestep=timestep))
    assert differing(rows) == {}


@pytest.mark.parametrize("gravity", [0.0, 1.62, 274.0])
@pytest.mark.parametrize("name", ENGINES)
def test_matched_engines_have_any_gravity(gentle: Scene, name: str, gravity: float) -> None:
    rows = stepping_engine(name).parity(Case(scene=replace(gentle, gravity=gravity), engine=name))
    assert differing(rows) == {}


@pytest.mark.parametrize("mu", [0.3, 0.0])
@pytest.mark.parametrize("name", ENGINES)
def test_a_declared_friction_is_that_of_the_pair(brief: Scene, name: str, mu: float) -> None:
    scene = replace(brief, effects=Effects(slip=Slip(mu=mu)))
    e = evaluated(scene, name, 1e-3)
    assert e.simulation.outcome is Outcome.FINISHED
    (friction,) = (r for r in e.simulation.parity if r.quantity == "friction of the pair")
    assert friction.declared == mu
    # the probe slides at full friction; solvers stop at 1e-6 of it or less
    assert friction.found == pytest.approx(mu, rel=1e-6, abs=1e-9)
    assert e.motion is not None
    # and so does the run: no contact takes more than its cone allows, to the same tolerance
    assert e.motion.friction_ratio.max() <= mu * (1.0 + 1e-6) + 1e-9


def test_mujoco_as_it_ships_has_the_can_of_the_scene(gentle: Scene) -> None:
    rows = stepping_engine("mujoco").parity(Case(scene=gentle, engine="mujoco", profile="default"))
    assert differing(rows) == {}


@pytest.mark.parametrize("timestep", [None, 1e-3, 1e-5])
def test_pybullet_as_it_ships_goes_its_own_way_and_says_so(
    gentle: Scene, timestep: float | None
) -> None:
    case = Case(scene=gentle, engine="pybullet", profile="default", timestep=timestep)
    rows = stepping_engine("pybullet").parity(case)
    assert differing(rows) == dict.fromkeys(
        (
            "transverse inertia A",
            "axial inertia C",
            "linear damping",
            "angular damping",
            "speed kept",
            "spin kept",
            "radius R",
            "half height H",
            "rim deviation",
        ),
        "imposed",
    )
    found = {row.quantity: row.found for row in rows}
    # the margin of 1 mm lies outside the prism all round, and to it the lengths are not exact
    assert found["rim deviation"] == pytest.approx(1e-3, rel=1e-9)
    assert abs(found["spin kept"]) == pytest.approx(100.0, rel=1e-9)  # the clamp


@pytest.mark.parametrize(
    ("setting", "value", "quantities"),
    [
        ("collisionMargin", 0.001, {"radius R", "half height H", "rim deviation"}),
        ("URDF_USE_IMPLICIT_CYLINDER", False, {"radius R", "rim deviation"}),
        ("URDF_USE_INERTIA_FROM_FILE", False, {"transverse inertia A", "axial inertia C"}),
        ("linearDamping", 0.04, {"linear damping", "speed kept"}),
        ("angularDamping", 0.04, {"angular damping", "spin kept"}),
        ("maxJointVelocity", 100.0, {"speed kept", "spin kept"}),
    ],
)
def test_what_the_matched_profile_undoes_stops_the_run_when_it_is_back(
    gentle: Scene, setting: str, value: Value, quantities: set[str]
) -> None:
    options: dict[str, Any] = {setting: value}
    e = evaluated(gentle, "pybullet", 1e-3, **options)
    assert e.simulation.outcome is Outcome.MISMATCH
    assert set(e.simulation.note.split(", ")) == quantities
    assert e.simulation.trajectory is None
    assert differing(e.simulation.parity) == dict.fromkeys(quantities, "mismatch")
    assert e.errors is None


def test_frictionless_contact_stops_a_mujoco_run_that_must_not_slip(gentle: Scene) -> None:
    e = evaluated(gentle, "mujoco", 1e-3, condim=1)
    assert e.simulation.outcome is Outcome.MISMATCH
    assert e.simulation.note == "friction of the pair"
