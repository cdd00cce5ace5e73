"""Model parity of both engines: equal where matched, owned up to where shipped, fatal elsewhere."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.core.simulation import Outcome, ParityRow
from harness.engines.parity.checks import parity
from harness.engines.parity.contact import FRICTIONS
from harness.engines.registry import engine
from models import NO_SLIP_FRICTION, Can, Effects, Restitution, Scene, Slip, load
from tests.support.engines import (
    CONTACTS,
    DOUBLE,
    INSTALLED,
    STEPPING,
    imposed,
    stepping_engine,
)
from tests.support.evaluations import evaluated

ENGINES = STEPPING
CANS = {
    "paper": Can.from_groups(mass=0.043, radius=0.037, a=0.727, c=0.615, h=1.473),
    "flat heavy disk": Can.from_groups(mass=2.0, radius=0.2, a=0.27, c=0.5, h=0.1),
    "tall light tube": Can.from_groups(mass=0.004, radius=0.01, a=5.0, c=0.9, h=3.5),
}


def honouring(effect: str) -> list[str]:
    """Return the installed engines that honour an effect."""
    return [name for name in INSTALLED if effect in engine(name).capabilities.honours]


def differing(rows: tuple[ParityRow, ...]) -> dict[str, Any]:
    """Return the verdict of each quantity that is not equal."""
    told = {"equal", "does not apply"}
    return {row.quantity: row.verdict for row in rows if row.verdict not in told}


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize("scene", ["gentle-rock", "paper-release", "steady-rolling", "wobble"])
def test_matched_engines_have_the_can_of_the_scene(name: str, scene: str) -> None:
    case = Case(scene=load(scene), engine=name)
    rows = stepping_engine(name).parity(case)
    assert differing(rows).items() <= dict.fromkeys(imposed(case), "imposed").items()
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
        "friction between the axes",
        "misfit of the gyroscopic acceleration",
    }


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize("can", CANS)
@pytest.mark.parametrize("timestep", [1e-3, 1e-6])
def test_matched_engines_have_any_can_at_any_timestep(
    gentle: Scene, name: str, can: str, timestep: float
) -> None:
    scene = replace(gentle, can=CANS[can])
    case = Case(scene=scene, engine=name, timestep=timestep)
    rows = stepping_engine(name).parity(case)
    assert differing(rows).items() <= dict.fromkeys(imposed(case), "imposed").items()


def of_another_world(case: Case, built: Scene) -> set[str]:
    """Return what is refused of a world of another scene, held against the scene of a case."""
    chosen = stepping_engine(case.engine)
    said = chosen.description
    rows = parity(
        chosen.open(replace(case, scene=built)),
        case.scene,
        chosen.interval(case),
        chosen.imposed_in(case),
        chosen.precision(case),
        method=said.method,
        tells_forces=said.tells_forces,
    )
    return {row.quantity for row in rows if row.verdict == "mismatch"}


@pytest.mark.parametrize("profile", ["default", "matched"])
@pytest.mark.parametrize("name", ENGINES)
def test_a_world_of_another_can_is_refused(gentle: Scene, name: str, profile: str) -> None:
    wider = replace(gentle, can=replace(gentle.can, radius=1.2 * gentle.can.radius))
    case = Case(scene=gentle, engine=name, profile=profile)
    assert of_another_world(case, wider) >= {"radius R", "rim deviation"}


@pytest.mark.parametrize("profile", ["default", "matched"])
@pytest.mark.parametrize("name", honouring("restitution"))
def test_a_world_of_another_rebound_is_refused(gentle: Scene, name: str, profile: str) -> None:
    declared, built = (
        replace(gentle, effects=Effects(restitution=Restitution(coefficient=e))) for e in (0.9, 0.3)
    )
    case = Case(scene=declared, engine=name, profile=profile, timestep=1e-4)
    assert "restitution" in of_another_world(case, built)


@pytest.mark.parametrize("name", honouring("slip"))
def test_a_world_of_another_friction_is_refused(gentle: Scene, name: str) -> None:
    declared, built = (replace(gentle, effects=Effects(slip=Slip(mu=mu))) for mu in (0.3, 0.6))
    case = Case(scene=declared, engine=name, timestep=1e-4)
    assert of_another_world(case, built) >= set(FRICTIONS)


@pytest.mark.parametrize("gravity", [0.0, 1.62, 274.0])
@pytest.mark.parametrize("name", DOUBLE)
def test_matched_engines_have_any_gravity(gentle: Scene, name: str, gravity: float) -> None:
    case = Case(scene=replace(gentle, gravity=gravity), engine=name)
    rows = stepping_engine(name).parity(case)
    assert differing(rows).items() <= dict.fromkeys(imposed(case), "imposed").items()


@pytest.mark.parametrize("mu", [0.3, 0.0])
@pytest.mark.parametrize("name", [name for name in CONTACTS if name in DOUBLE])
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
    # where a step leaves the can without a contact there is no ratio
    # and a normal that a collider finds by iteration is some 1e-9 rad off the vertical
    assert np.nanmax(e.motion.friction_ratio) <= mu * (1.0 + 1e-6) + 1e-8


def test_mujoco_as_it_ships_has_the_can_of_the_scene(gentle: Scene) -> None:
    rows = stepping_engine("mujoco").parity(Case(scene=gentle, engine="mujoco", profile="default"))
    # but for the pyramid, which bears mu along its edges and less between them
    assert differing(rows) == {"friction between the axes": "imposed"}
    found = {row.quantity: row.found for row in rows}["friction between the axes"]
    assert found == pytest.approx(NO_SLIP_FRICTION / (math.cos(0.4) + math.sin(0.4)), rel=0.03)


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
    assert e.simulation.note == "friction of the pair, friction between the axes"
