"""MuJoCo Warp: what it ships with, the rim in single precision, and settings to paste."""

import re
import subprocess
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.core.errors import HarnessError, UnknownSettingError
from harness.engines.description import Precision
from harness.engines.probes.rim_contact import collision, turns
from harness.engines.registry import engine, export_settings, not_installed, variants
from harness.engines.stepping.settling import UP, lowered, moving
from harness.evaluation.evaluate import evaluate
from models import Scene
from models.rim import released
from tests.support.engines import stepping_engine
from tests.support.evaluations import turn_error

pytestmark = pytest.mark.engine("mujoco-warp")


def case_of(scene: Scene, timestep: float | None = None, **options: Value) -> Case:
    """Return a matched case of MuJoCo Warp."""
    return Case(
        scene=scene, engine="mujoco-warp", timestep=timestep, options=tuple(options.items())
    )


@pytest.mark.parametrize(
    ("timestep", "error", "known"),
    [
        # numbers of 24 bits: what the bounce makes of an ulp grows with the steps
        (1e-3, 0.207, 1e-3),
        (1e-4, -0.0072, 2e-3),
        pytest.param(1e-5, 0.0, 0.1, marks=pytest.mark.slow),
    ],
)
def test_the_gentle_release_turns_as_in_the_record(
    gentle: Scene, timestep: float, error: float, known: float
) -> None:
    assert turn_error(case_of(gentle, timestep)) == pytest.approx(error, abs=known)


def test_parity_tells_the_rim_in_single_precision(gentle: Scene) -> None:
    rows = {row.quantity: row for row in engine("mujoco-warp").parity(case_of(gentle, 1e-4))}  # type: ignore[attr-defined]
    assert {row.verdict for row in rows.values()} == {"equal", "imposed"}
    rim = rows["rim deviation"]
    assert rim.verdict == "imposed"
    # R eps/phi at the smallest tilt that is probed, 0.02 rad
    assert 0.1 < rim.found / (gentle.can.radius * Precision.SINGLE.epsilon / 0.02) < 10.0


def test_another_timestep_means_the_same(gentle: Scene) -> None:
    chosen: Any = stepping_engine("mujoco-warp")
    pose, twist = released(gentle)
    states = []
    for timestep in (1e-4, 2e-4):
        world = chosen.open(case_of(gentle, timestep))
        world.set_timestep(1.5e-4)
        world.place(lowered(pose, 1e-8), twist)
        for _ in range(3):
            world.step()
        states.append(np.concatenate((world.pose().position, world.twist().velocity)))
    assert states[0].tobytes() == states[1].tobytes()


def test_a_stage_gives_the_bits_of_its_steps(gentle: Scene) -> None:
    chosen: Any = stepping_engine("mujoco-warp")
    pose, twist = released(gentle)
    one, many = (chosen.open(case_of(gentle, 1e-4)) for _ in range(2))
    for world in (one, many):
        world.place(lowered(pose, 1e-8), twist)
    count = 4100  # more than fit into the arrays
    rows, _ = many.roll(np.arange(count) * 1e-4)
    for number in range(count):
        if number:  # the first is in single precision in the arrays alone
            assert one.pose().position.tobytes() == rows[number, :3].tobytes()
        one.step()
    assert one.contact().force.tobytes() == many.contact().force.tobytes()


@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
def test_the_sensors_are_those_of_mujoco(gentle: Scene, cone: str) -> None:
    pose, _ = released(gentle)
    found = []
    for name in ("mujoco-warp", "mujoco"):
        case = replace(case_of(gentle, 1e-4, cone=cone), engine=name)
        world = stepping_engine(name).open(case)
        world.place(lowered(pose, 1e-5), moving(velocity=np.array((0.1, -0.2, 0.0)) - 0.01 * UP))
        world.step()
        contact = world.contact()
        found.append(np.concatenate((contact.point, contact.force, [contact.penetration])))
        assert contact.count == 1
    # a depth of 1e-5 m is known to an ulp of the height, 4e-9 m, and the force goes with it
    assert found[0] == pytest.approx(found[1], rel=5e-3, abs=1e-7)


def test_what_it_ships_with_is_what_is_stated(gentle: Scene) -> None:
    import mujoco  # noqa: PLC0415
    import mujoco_warp  # noqa: PLC0415 - may not be installed

    stated = {setting.name: setting.default for setting in engine("mujoco-warp").settings}
    option = mujoco_warp.put_model(mujoco.MjModel.from_xml_string("<mujoco/>")).opt
    for name in ("iterations", "ls_iterations"):
        assert getattr(option, name) == stated[name]
    # MuJoCo ships with 1e-8, and MuJoCo Warp makes 1e-6 of it
    assert float(option.tolerance.numpy()[0]) == pytest.approx(1e-6)
    shipped = Case(scene=gentle, engine="mujoco-warp", profile="default")
    timestep = stepping_engine("mujoco-warp").timestep(shipped)
    assert float(option.timestep.numpy()[0]) == np.float32(timestep)


@pytest.mark.parametrize(
    "variant",
    () if "mujoco-warp" in not_installed() else variants("mujoco-warp"),
    ids=lambda variant: getattr(variant, "name", variant),
)
def test_what_is_pasted_runs_and_means_the_case(gentle: Scene, variant: Any) -> None:
    import mujoco  # noqa: PLC0415
    import mujoco_warp  # noqa: PLC0415 - may not be installed
    import warp  # noqa: PLC0415

    case = replace(case_of(gentle, 2.0**-12), profile=variant.profile, options=variant.settings)
    text, chosen = export_settings(case), stepping_engine("mujoco-warp").resolve(case)
    scene = f'<mujoco>{text}<worldbody><geom type="plane" size="1 1 1"/></worldbody></mujoco>'
    model = mujoco_warp.put_model(mujoco.MjModel.from_xml_string(scene))
    assert int(model.opt.cone) == ["pyramidal", "elliptic"].index(str(chosen["cone"]))
    assert model.opt.iterations == chosen["iterations"]
    assert model.opt.timestep.numpy().tolist() == [2.0**-12]
    assert model.geom_solref.numpy()[0, 0, 0] == np.float32(chosen["solref"][0])  # type: ignore[index]
    if variant.profile == "adaptive":
        (lines,) = re.findall(r"angular velocity\)\n(.*?)\n-->", text, flags=re.DOTALL)
        exec(lines, {"model": model, "step": 2.0**-13, "warp": warp})  # noqa: S102 - a user would
        assert model.opt.timestep.numpy().tolist() == [2.0**-13]
        assert model.geom_solref.numpy().tolist() == [[[2.0**-12, 1.0]]]


def test_what_mujoco_warp_does_not_have_is_refused_with_the_reason(gentle: Scene) -> None:
    for options in ({"solver": "PGS"}, {"integrator": "discrete", "noslip_iterations": 3}):
        with pytest.raises(HarnessError, match=next(iter(options))):
            evaluate(case_of(gentle, 1e-3, **options))


@pytest.mark.parametrize("shapes", ["mesh-plane", "cylinder-box", "mesh-box"])
def test_other_shapes_touch_at_the_side_of_the_can_that_is_lower(
    gentle: Scene, shapes: str
) -> None:
    world, depth = (
        stepping_engine("mujoco-warp").open(case_of(gentle, shapes=shapes)),
        1e-3 * gentle.can.radius,
    )
    for stance in turns(1e-4, [depth]):
        pose, lowest = stance.put(gentle.can)
        world.place(pose, moving())
        found = collision(world)
        deepest = int(np.argmax(found.depths))
        # within a corner of the prism, and of a box in single precision
        assert found.depths[deepest] == pytest.approx(depth, rel=0.05)
        assert found.points[deepest, :2] @ lowest[:2] > 0.0
        np.testing.assert_allclose(found.normals[deepest], UP, atol=1e-3)
        assert world.signed_distance() == pytest.approx(-depth, rel=0.05)


@pytest.mark.parametrize(("name", "word"), [("nativeccd", "disable"), ("ccd_tolerance", 1e-12)])
def test_a_collider_of_mujoco_alone_is_refused(gentle: Scene, name: str, word: Value) -> None:
    with pytest.raises(UnknownSettingError, match=name):
        stepping_engine("mujoco-warp").open(case_of(gentle, None, **{name: word}))


def test_nothing_is_printed_where_it_is_started() -> None:
    program = "import harness.engines.mujoco.warp.world"
    done = subprocess.run(  # noqa: S603 - our own program
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert (done.stdout, done.stderr) == ("", "")
