"""What is stated as an engine's default is what it ships with, read from a model it compiles."""

import importlib
import math

import mujoco
import numpy as np
import pytest

from harness.core.case import PROFILES, Case
from harness.engines.base import Setting, resolve
from harness.engines.mujoco.settings import FLAGS, GEOM, OPTIONS
from harness.engines.probes import ProbeFinding, measure
from harness.engines.registry import engine
from models import load, release_state
from tests.settings_table import ENGINES, FILE, kept_rows, rows_of, settings_table
from tests.support.engines import STEPPING, stepping_engine

BARE = """
<mujoco><worldbody>
  <geom name="ground" type="plane" size="0 0 1"/>
  <body pos="0 0 1"><freejoint/><geom name="can" type="cylinder" size="0.04 0.05" mass="1"/></body>
</worldbody></mujoco>
"""
"""A model that sets nothing."""

WORDS = {
    "integrator": ("mjINT_", mujoco.mjtIntegrator),
    "cone": ("mjCONE_", mujoco.mjtCone),
    "jacobian": ("mjJAC_", mujoco.mjtJacobian),
    "solver": ("mjSOL_", mujoco.mjtSolver),
}


@pytest.fixture(scope="module")
def bare() -> mujoco.MjModel:
    """Return a compiled model in which nothing was chosen."""
    return mujoco.MjModel.from_xml_string(BARE)


@pytest.mark.parametrize("setting", OPTIONS, ids=lambda setting: setting.name)
def test_mujoco_options(bare: mujoco.MjModel, setting: Setting) -> None:
    found = getattr(bare.opt, setting.name)
    if setting.name in WORDS:
        prefix, kinds = WORDS[setting.name]
        assert kinds(found) == getattr(kinds, prefix + str(setting.default).upper())
    else:
        assert found == setting.default


@pytest.mark.parametrize("setting", GEOM, ids=lambda setting: setting.name)
def test_mujoco_geoms(bare: mujoco.MjModel, setting: Setting) -> None:
    found = np.ravel(getattr(bare, f"geom_{setting.name}")[bare.geom("can").id])
    np.testing.assert_array_equal(found, np.ravel(np.asarray(setting.default)))


@pytest.mark.parametrize("setting", FLAGS, ids=lambda setting: setting.name)
def test_mujoco_flags(bare: mujoco.MjModel, setting: Setting) -> None:
    bit = getattr(mujoco.mjtDisableBit, f"mjDSBL_{setting.name.upper()}")
    disabled = bool(bare.opt.disableflags & bit)
    assert setting.default == ("disable" if disabled else "enable")


def test_mujoco_words_are_all_there_are(bare: mujoco.MjModel) -> None:
    del bare
    for setting in OPTIONS:
        if setting.name in WORDS:
            prefix, kinds = WORDS[setting.name]
            members = {name.removeprefix(prefix).lower() for name in kinds.__members__}
            assert {choice.lower() for choice in setting.choices} == members


def test_mujoco_timestep(bare: mujoco.MjModel) -> None:
    case = Case(scene=load("gentle-rock"), engine="mujoco", profile="default")
    assert engine("mujoco").timestep(case) == bare.opt.timestep


@pytest.fixture(scope="module")
def parameters() -> dict[str, float]:
    """Return what a fresh PyBullet world says of itself."""
    pybullet = importlib.import_module("pybullet")  # after the adapter, which silences its greeting
    client = pybullet.connect(pybullet.DIRECT)
    try:
        return dict(pybullet.getPhysicsEngineParameters(client))
    finally:
        pybullet.disconnect(client)


def shipped(name: str) -> float:
    """Return the number that is stated to be PyBullet's own."""
    (unset,) = (setting.unset for setting in engine("pybullet").settings if setting.name == name)
    return float(unset.split()[0])


@pytest.mark.engine("pybullet")
def test_pybullet_engine_parameters(parameters: dict[str, float]) -> None:
    stated = {setting.name: setting.default for setting in engine("pybullet").settings}
    assert parameters["numSolverIterations"] == stated["numSolverIterations"]
    case = Case(scene=load("gentle-rock"), engine="pybullet", profile="default")
    assert parameters["fixedTimeStep"] == engine("pybullet").timestep(case)
    for key in ("contactERP", "frictionERP"):
        if key in parameters:
            assert parameters[key] == pytest.approx(shipped(key), rel=1e-12)


@pytest.fixture(scope="module")
def findings() -> dict[str, ProbeFinding]:
    """Return what the probes find in PyBullet as it ships, by quantity."""
    case = Case(scene=load("gentle-rock"), engine="pybullet", profile="default")
    return {finding.quantity: finding for finding in measure(case).findings}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "quantity"),
    [
        ("linearDamping", "linear damping of velocity"),
        ("linearDamping", "quadratic damping of velocity"),
        ("angularDamping", "linear damping of spin"),
        ("maxJointVelocity", "greatest velocity left by a step"),
        ("maxJointVelocity", "greatest spin left by a step"),
        ("collisionMargin", "swell beyond the declared size"),
        ("contactSlop", "static penetration under its weight"),
    ],
)
def test_pybullet_ships_what_is_stated(
    findings: dict[str, ProbeFinding], name: str, quantity: str
) -> None:
    # what is probed is a difference of numbers a million times as large as their round-off, at most
    assert findings[quantity].value == pytest.approx(shipped(name), rel=1e-6)


@pytest.mark.slow
def test_pybullet_ships_a_prism(findings: dict[str, ProbeFinding]) -> None:
    assert findings["sides of the rim; 0 is round"].value == 32.0
    radius = load("gentle-rock").can.radius
    # the lowest point between two corners is among 8 azimuths a side
    sagitta = radius * (1.0 - math.cos(math.pi / 32.0))
    assert findings["sagitta between the corners over sin phi"].value == pytest.approx(
        sagitta, rel=0.05
    )


@pytest.mark.parametrize("name", STEPPING)
def test_handing_over_the_default_changes_nothing(name: str) -> None:
    """A default that is stated is also what `--set` would hand over in its place."""
    scene = load("gentle-rock")
    settings = engine(name).settings
    whole = Case(scene=scene, engine=name, profile="default")
    chosen = resolve(whole, settings, engine(name).timestep(whole) or 0.0)
    given = tuple((key, value) for key, value in chosen.items() if value is not None)
    told = Case(scene=scene, engine=name, profile="default", options=given)
    runs = []
    for case in (whole, told):
        world = stepping_engine(name).open(case)
        world.place(*release_state(scene.can, scene.release))
        for _ in range(20):
            world.step()
        runs.append(world.pose().position)
    np.testing.assert_array_equal(*runs)


_AGAIN = "run: python -m tests.settings_table"


def test_the_table_is_made_by_its_program() -> None:
    assert FILE.read_text(encoding="utf-8") == settings_table(), _AGAIN


@pytest.mark.parametrize("name", ENGINES)
def test_the_table_is_that_of_the_code(name: str) -> None:
    assert kept_rows(name) == list(rows_of(name)), _AGAIN


@pytest.mark.parametrize("name", ENGINES)
def test_the_table_has_every_setting_in_every_profile(name: str) -> None:
    header = next(line for line in FILE.read_text().splitlines() if line.startswith("| Engine"))
    for profile in PROFILES:
        assert profile.capitalize() in header
    lines = kept_rows(name)
    for setting in engine(name).settings:
        (line,) = [one for one in lines if one.startswith(f"| {name} | `{setting.name}` |")]
        assert line.count("|") == 7
        assert setting.meaning in line
