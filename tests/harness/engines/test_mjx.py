"""MJX: what it ships with, its precisions beside each other, and settings to paste."""

import re
from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.core.errors import HarnessError, InvalidSettingError
from harness.engines.base import features_of
from harness.engines.description import Precision
from harness.engines.linearised import change_between
from harness.engines.probes.rim_contact import collision, turns
from harness.engines.registry import engine, export_settings, not_installed, variants
from harness.engines.stepping.settling import UP, lowered, moving
from harness.evaluation.evaluate import evaluate
from models import Horizon, Scene, load
from models.rim import released
from tests.support.engines import stepping_engine
from tests.support.evaluations import turn_error

pytestmark = pytest.mark.engine("mjx")

SINGLE = {"jax_enable_x64": False}


def case_of(scene: Scene, timestep: float | None = None, **options: Value) -> Case:
    """Return a matched case of MJX."""
    return Case(scene=scene, engine="mjx", timestep=timestep, options=tuple(options.items()))


@pytest.mark.parametrize(
    ("timestep", "error"),
    [(1e-3, 0.2065), (1e-4, -0.0072), pytest.param(1e-5, -0.0012, marks=pytest.mark.slow)],
)
def test_the_gentle_release_turns_as_in_mujoco(
    gentle: Scene, timestep: float, error: float
) -> None:
    own = case_of(gentle, timestep)
    assert turn_error(own) == pytest.approx(error, abs=1e-4)
    # another order of the same sums: round-off that the bounce has not amplified
    assert turn_error(own) == pytest.approx(turn_error(replace(own, engine="mujoco")), abs=1e-6)


def test_the_paper_release_turns_with_adaptive_steps_in_double_precision_alone() -> None:
    case = replace(case_of(load("paper-release")), profile="adaptive")
    assert abs(turn_error(case)) < 1e-3
    assert abs(turn_error(replace(case, options=tuple(SINGLE.items())))) > 10.0


def test_a_setting_of_jax_decides_the_precision_of_a_case_and_of_nothing_else(
    gentle: Scene,
) -> None:
    import jax  # noqa: PLC0415 - may not be installed

    chosen: Any = stepping_engine("mjx")
    for options, precision in (({}, Precision.DOUBLE), (SINGLE, Precision.SINGLE)):
        case = case_of(gentle, 1e-4, **options)
        assert chosen.precision(case) is precision
        world = chosen.open(case)
        digits = abs(world.mass / gentle.can.mass - 1.0)
        assert (digits == 0.0) is (precision is Precision.DOUBLE)
        assert digits < precision.epsilon
        assert jax.numpy.zeros(1).dtype == np.float32  # as the user of JAX has it
    shipped = Case(scene=gentle, engine="mjx", profile="default")
    assert chosen.precision(shipped) is Precision.SINGLE


@pytest.mark.parametrize("options", [{}, SINGLE], ids=["double", "single"])
def test_parity_tells_the_rim_in_single_precision(gentle: Scene, options: dict[str, Value]) -> None:
    rows = {row.quantity: row for row in engine("mjx").parity(case_of(gentle, 1e-4, **options))}  # type: ignore[attr-defined]
    verdicts = {row.verdict for row in rows.values()}
    assert verdicts == ({"equal", "imposed"} if options else {"equal"})
    if options:
        rim = rows["rim deviation"]
        assert rim.verdict == "imposed"
        # R eps/phi at the smallest tilt that is probed, 0.02 rad
        assert 0.1 < rim.found / (gentle.can.radius * Precision.SINGLE.epsilon / 0.02) < 10.0


def test_another_timestep_compiles_nothing_and_means_the_same(gentle: Scene) -> None:
    chosen: Any = stepping_engine("mjx")
    worlds = [chosen.open(case_of(gentle, timestep)) for timestep in (1e-4, 2e-4)]
    pose, twist = released(gentle)
    assert worlds[0].loop is worlds[1].loop
    compiled = None
    states = []
    for world in worlds:
        world.set_timestep(1.5e-4)
        world.place(lowered(pose, 1e-8), twist)
        for _ in range(3):
            world.step()
        compiled = compiled or world.loop._cache_size()  # noqa: SLF001 - JAX tells it so alone
        states.append(np.concatenate((world.pose().position, world.twist().velocity)))
    assert worlds[1].loop._cache_size() == compiled  # noqa: SLF001 - likewise
    assert states[0].tobytes() == states[1].tobytes()


def test_a_stage_gives_the_bits_of_its_steps(gentle: Scene) -> None:
    chosen: Any = stepping_engine("mjx")
    pose, twist = released(gentle)
    one, many = (chosen.open(case_of(gentle, 1e-4)) for _ in range(2))
    for world in (one, many):
        world.place(lowered(pose, 1e-8), twist)
    count = 300  # more than fit into one call
    rows, _ = many.roll(np.arange(count) * 1e-4)
    for number in range(count):
        assert one.pose().position.tobytes() == rows[number, :3].tobytes()
        one.step()
    assert one.contact().force.tobytes() == many.contact().force.tobytes()


@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
def test_the_resultant_is_that_of_the_sensors_of_mujoco(gentle: Scene, cone: str) -> None:
    pose, _ = released(gentle)
    found = []
    for name in ("mjx", "mujoco"):
        case = replace(case_of(gentle, 1e-4, cone=cone), engine=name)
        world = stepping_engine(name).open(case)
        world.place(lowered(pose, 1e-5), moving(velocity=np.array((0.1, -0.2, 0.0)) - 0.01 * UP))
        world.step()
        contact = world.contact()
        found.append(np.concatenate((contact.point, contact.force, [contact.penetration])))
        assert contact.count == 1
    assert found[0] == pytest.approx(found[1], rel=1e-6)


def test_what_it_ships_with_is_what_is_stated(gentle: Scene) -> None:
    import jax  # noqa: PLC0415 - may not be installed
    import mujoco  # noqa: PLC0415

    stated = {setting.name: setting.default for setting in engine("mjx").settings}
    assert jax.config.jax_enable_x64 is stated.pop("jax_enable_x64")
    option = mujoco.MjModel.from_xml_string("<mujoco/>").opt
    for name in ("impratio", "iterations", "ls_iterations", "ls_tolerance", "tolerance"):
        assert getattr(option, name) == stated[name]
    assert stepping_engine("mjx").timestep(
        Case(scene=gentle, engine="mjx", profile="default")
    ) == pytest.approx(option.timestep, abs=0.0)


@pytest.mark.parametrize(
    "variant",
    () if "mjx" in not_installed() else variants("mjx"),
    ids=lambda variant: getattr(variant, "name", variant),
)
def test_what_is_pasted_runs_and_means_the_case(gentle: Scene, variant: Any) -> None:
    import jax  # noqa: PLC0415 - may not be installed
    import jax.numpy as jnp  # noqa: PLC0415
    import mujoco  # noqa: PLC0415
    from mujoco import mjx  # noqa: PLC0415

    case = replace(case_of(gentle, 2.0**-12), profile=variant.profile, options=variant.settings)
    text, chosen = export_settings(case), stepping_engine("mjx").resolve(case)
    (before,) = re.findall(r"put_model\(model\)`:\n(.*)\n-->", text)
    own: dict[str, Any] = {"jax": jax, "jnp": jnp}
    try:
        exec(before, own)  # noqa: S102 - a user would
        assert jax.config.jax_enable_x64 is chosen["jax_enable_x64"]
        scene = f'<mujoco>{text}<worldbody><geom type="plane" size="1 1 1"/></worldbody></mujoco>'
        model = mjx.put_model(mujoco.MjModel.from_xml_string(scene))
        assert int(model.opt.cone) == ["pyramidal", "elliptic"].index(str(chosen["cone"]))
        assert float(model.opt.timestep) == 2.0**-12
        assert float(model.geom_solref[0, 0]) == pytest.approx(chosen["solref"][0], rel=1e-7)  # type: ignore[index]
        if variant.profile == "adaptive":
            (lines,) = re.findall(r"angular velocity\)\n(.*?)\n-->", text, flags=re.DOTALL)
            own |= {"model": model, "step": 2.0**-13}
            exec(lines, own)  # noqa: S102 - likewise
            assert float(own["model"].opt.timestep) == 2.0**-13
            assert own["model"].geom_solref.tolist() == [[2.0**-12, 1.0]]
    finally:
        jax.config.update("jax_enable_x64", False)  # noqa: FBT003 - as the rest has it


def test_what_mjx_does_not_have_is_refused_with_the_reason(gentle: Scene) -> None:
    for options in ({"solver": "PGS"}, {"noslip_iterations": 3}):
        with pytest.raises(HarnessError, match=next(iter(options))):
            evaluate(case_of(gentle, 1e-3, **options))


@pytest.mark.parametrize(
    ("shapes", "tilts", "least"),
    [("mesh-plane", (0.03, 0.1), 1.0), ("mesh-box", (0.03,), 0.0)],  # of a box any corner
)
def test_a_mesh_touches_as_deep_as_that_of_mujoco(
    gentle: Scene, shapes: str, tilts: tuple[float, ...], least: float
) -> None:
    depth = 1e-3 * gentle.can.radius
    own, theirs = (
        stepping_engine(name).open(replace(case_of(gentle, shapes=shapes), engine=name))
        for name in ("mjx", "mujoco")
    )
    sunk = 0
    for stance in (each for tilt in tilts for each in turns(tilt, [depth])):
        pose, _ = stance.put(gentle.can)
        for world in (own, theirs):
            world.place(pose, moving())
        found, lowest = collision(own), -theirs.signed_distance()
        assert own.signed_distance() == pytest.approx(-lowest, abs=1e-12)
        if lowest > 0.0:  # else a corner of the prism is above the ground
            deepest = int(np.argmax(found.depths))
            assert least - 1e-6 < found.depths[deepest] / lowest < 1.0 + 1e-6
            np.testing.assert_allclose(found.normals[deepest], UP, atol=1e-9)
            sunk += 1
    assert sunk >= 4 * len(tilts)


def test_a_corner_that_is_shallow_in_a_box_is_pushed_out_at_a_side_of_the_box(
    gentle: Scene,
) -> None:
    world = stepping_engine("mjx").open(case_of(gentle, shapes="mesh-box"))
    _, stance, *_ = turns(0.1, [1e-3 * gentle.can.radius])
    world.place(stance.put(gentle.can)[0], moving())
    assert -world.signed_distance() == pytest.approx(3.28e-5, rel=1e-2)
    assert collision(world).depths.max() > 100.0


def test_a_pair_of_shapes_that_mjx_has_no_function_for_is_refused(gentle: Scene) -> None:
    with pytest.raises(InvalidSettingError, match="cylinder-plane, mesh-plane, mesh-box"):
        stepping_engine("mjx").open(case_of(gentle, shapes="cylinder-box"))


@pytest.fixture
def compilations() -> Iterator[list[float]]:
    """Return how long each compilation of JAX takes, s, from where nothing is compiled yet."""
    jax = pytest.importorskip("jax")
    cache = import_module("jax.experimental.compilation_cache.compilation_cache")
    cache.reset_cache()
    enabled = jax.config.jax_enable_compilation_cache
    jax.config.update("jax_enable_compilation_cache", False)  # noqa: FBT003 - as JAX has it
    jax.clear_caches()
    found: list[float] = []

    def compiled(event: str, seconds: float, **_: object) -> None:
        if event == "/jax/core/compile/backend_compile_duration":
            found.append(seconds)

    jax.monitoring.register_event_duration_secs_listener(compiled)
    yield found
    jax.monitoring.unregister_event_duration_listener(compiled)
    cache.reset_cache()
    jax.config.update("jax_enable_compilation_cache", enabled)


def test_compiling_is_told_apart_and_once(gentle: Scene, compilations: list[float]) -> None:
    brief = replace(gentle, horizon=Horizon(seconds=0.005))
    # two programs whose compiling nothing else has told, and which differ in a number alone
    case, other = (case_of(brief, 1e-3, ls_tolerance=number) for number in (0.0125, 0.0126))
    told = stepping_engine("mjx").compile_s(case)
    in_it = sum(compilations)
    assert 0.0 < in_it < told
    compilations.clear()
    assert engine("mjx").simulate(case).compile_s == 0.0
    assert sum(compilations) < 0.1 * in_it  # of the probes, a hundredth
    compilations.clear()
    assert engine("mjx").simulate(other).compile_s > 0.0
    assert not compilations


def test_the_program_is_differentiated_where_the_cone_is_a_pyramid(gentle: Scene) -> None:
    """Derivatives of a run by its release are those of differences of the run itself."""
    own, seconds, size = stepping_engine("mjx"), 0.03, 1e-6
    linearise = features_of(own).linearise
    assert linearise is not None
    start = released(gentle)
    ends = []
    for sign in (-1.0, 1.0):
        release = replace(gentle.release, psi_dot=gentle.release.psi_dot + sign * size)
        ends.append(replace(gentle, release=release))
    change = change_between(start, released(ends[1]), size)[:, None]
    case = case_of(gentle, 1e-3, cone="pyramidal")
    run = linearise(case, change, seconds=seconds, step=1e-6)
    assert not run.why
    assert not run.by_differences
    down, up = (
        linearise(replace(case, scene=scene), change, seconds=seconds, step=1e-6).trajectory
        for scene in ends
    )
    moved = (up.angular_velocity - down.angular_velocity) / (2.0 * size)
    assert run.changes[:, 9:, 0] == pytest.approx(moved, rel=1e-4, abs=1e-5 * np.abs(moved).max())
    turned = 2.0 * np.abs(np.sum(run.changes[:, 3:6, 0] ** 2, axis=1)) ** 0.5
    apart = np.linalg.norm(up.quaternion - down.quaternion, axis=1) / (2.0 * size)
    assert turned == pytest.approx(4.0 * apart, rel=1e-4, abs=1e-6)

    # the elliptic cone of the profile `matched` has none, and says why
    refused = linearise(case_of(gentle, 1e-3), change, seconds=0.003, step=1e-6)
    assert "square root" in refused.why
    assert np.isnan(refused.changes[1:]).any()
