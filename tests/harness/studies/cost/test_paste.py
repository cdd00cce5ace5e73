"""What is printed to paste: MuJoCo compiles it, PyBullet runs it, and both mean the case."""

import math
from dataclasses import replace
from pathlib import Path

import mujoco
import pytest

from harness.core.case import Case
from harness.engines.mujoco.settings import matched_solref
from harness.engines.registry import export_settings, left_out, variants
from models import Damping, Effects, Slip, load
from models.mjcf_contact import spring
from models.to_urdf import urdf

SCENE = load("gentle-rock")


def compiled(text: str) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(
        f"<mujoco>{text}<worldbody><geom name='g' type='plane' size='0 0 1'/></worldbody></mujoco>"
    )


def test_mujoco_compiles_what_is_pasted() -> None:
    case = Case(
        scene=SCENE,
        engine="mujoco",
        timestep=3e-4,
        options=(("integrator", "RK4"), ("impratio", 10.0)),
    )
    model = compiled(export_settings(case))
    assert model.opt.timestep == 3e-4
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4
    assert model.opt.impratio == 10.0
    assert model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
    assert tuple(model.geom_solref[0]) == matched_solref(3e-4)


@pytest.mark.parametrize("variant", variants("mujoco"), ids=lambda variant: variant.name)
def test_every_variant_of_mujoco_compiles(variant: object) -> None:
    case = Case(
        scene=SCENE,
        engine="mujoco",
        profile=variant.profile,  # type: ignore[attr-defined]
        timestep=1e-3,
        options=variant.settings,  # type: ignore[attr-defined]
    )
    assert compiled(export_settings(case)).opt.timestep <= 1e-3


@pytest.mark.engine("pybullet")
@pytest.mark.parametrize(
    "variant",
    () if "pybullet" in left_out() else variants("pybullet"),
    ids=lambda variant: variant.name,
)
def test_pybullet_runs_what_is_pasted(
    variant: object, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import pybullet  # noqa: PLC0415 - may not be installed

    case = Case(
        scene=SCENE,
        engine="pybullet",
        profile=variant.profile,  # type: ignore[attr-defined]
        timestep=1e-3,
        options=variant.settings,  # type: ignore[attr-defined]
    )
    (tmp_path / "can.urdf").write_text(urdf(SCENE), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        names: dict[str, object] = {}
        exec(compile(export_settings(case), "pasted", "exec"), names)  # noqa: S102 - what a user would do
        told = pybullet.getPhysicsEngineParameters()
        if variant.profile != "adaptive":  # type: ignore[attr-defined]
            assert told["fixedTimeStep"] == 1e-3
        sweeps = dict(variant.settings).get("numSolverIterations", 50)  # type: ignore[attr-defined]
        assert told["numSolverIterations"] == sweeps
        mass, _, inertia, *_ = pybullet.getDynamicsInfo(names["can"], -1)
        assert mass == SCENE.can.mass
        if variant.profile != "default":  # type: ignore[attr-defined]
            assert inertia[2] == pytest.approx(SCENE.can.axial_inertia, rel=1e-12, abs=0)
    finally:
        pybullet.disconnect(client)


def test_what_an_effect_asks_for_is_pasted_too() -> None:
    slippery = replace(SCENE, effects=Effects(slip=Slip(mu=0.3)))
    text = export_settings(Case(scene=slippery, engine="mujoco", timestep=1e-4))
    solref = spring(slippery, 1e-4)
    assert solref is not None
    assert f'solref="{solref[0]!r} {solref[1]!r}"' in text
    assert text.count("<pair ") == 1
    damped = replace(SCENE, effects=Effects(damping=Damping(linear=0.5)))
    text = export_settings(Case(scene=damped, engine="pybullet", timestep=1e-4))
    assert f"linearDamping={-math.expm1(-0.5)!r}" in text
    assert "useMaximalCoordinates=True" in text
