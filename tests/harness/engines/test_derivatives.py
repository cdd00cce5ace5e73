"""Derivatives of the first bounce by the keys of a scene, in the units of both."""

import json
import math
from dataclasses import fields, replace

import numpy as np
import pytest
from typer.testing import CliRunner

from harness.cli.commands import app
from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.engines.reference.derivatives import NAMES, OTHER_LAW_AT, derivatives_of, scene_numbers
from harness.engines.reference.to_reference_problem import problem
from harness.engines.reference.truth import solve_case
from harness.sweep.axes import read_axis
from harness.sweep.parameters import scene_at
from harness.sweep.partition import compute
from harness.sweep.plan import plan_sweep
from models.body_effects import Damping, Shake
from models.catalogue import load
from models.contact_effects import (
    AirFilm,
    Compliance,
    ContourFriction,
    Drilling,
    RoundedRim,
    Slip,
)
from models.effects import Effects
from models.scene import Scene
from reference.analysis.sensitivity import sensitivity


def measured(scene: Scene) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    case = Case(scene=scene, engine="reference")
    bounce = solve_case(case, again=False).bounces[0]
    return np.array(
        [
            bounce.end - bounce.start,
            math.degrees(bounce.angle_of_turn),
            bounce.phi_min,
            bounce.peak_psi_dot,
            bounce.peak_friction_ratio,
        ]
    )


EFFECTS = {
    "none": Effects(),
    "damping": Effects(damping=Damping(linear=0.3, angular=0.2)),
    "drilling, rim": Effects(drilling=Drilling(length=1e-4), rim=RoundedRim(radius=1e-3)),
    "shake": Effects(
        shake=Shake(frequency=5.0, horizontal=1e-3, vertical=5e-4, direction=0.3, phase=0.2)
    ),
    "contour friction, boundary layers": Effects(
        contour_friction=ContourFriction(coulomb=1e-3, viscous=1e-4),
        air_film=AirFilm(viscosity=1.8e-4, density=1.2),
    ),
    "film": Effects(
        contour_friction=ContourFriction(viscous=1e-4), air_film=AirFilm(viscosity=1.8e-4)
    ),
    "static friction": Effects(slip=Slip(mu=0.3, mu_static=0.35)),
    "a patch": Effects(slip=Slip(mu=0.3, patch=1e-3)),
    "compliance": Effects(compliance=Compliance(stiffness=1e4, damping=5.0)),
    "compliance after Hertz": Effects(
        compliance=Compliance(stiffness=1e6, damping=1e6, exponent=1.5)
    ),
}


@pytest.mark.parametrize("effects", EFFECTS.values(), ids=EFFECTS.keys())
def test_differences_of_scenes(effects: Effects) -> None:
    """By every key, gravity and radius too, to 1e-7 of what a change of its own size does."""
    scene = replace(load("gentle-rock"), effects=effects)
    known, numbers = derivatives_of(scene), scene_numbers(scene)
    assert not known.why
    for key, value in numbers.items():
        if key == "release.phi_dot":  # at rest: of one side
            continue
        if value == OTHER_LAW_AT.get(key):
            assert all(known.slopes[name][key] is None for name in NAMES.values())
            assert any(key in sentence for sentence in known.caveats)
            continue
        step = 1e-4 * value
        one, two = (
            (
                measured(scene_at(scene, {key: value + h}))
                - measured(scene_at(scene, {key: value - h}))
            )
            / (2 * h)
            for h in (step / 2, step)
        )
        slopes = np.array([known.slopes[name][key] for name in NAMES.values()], dtype=float)
        sizes = np.abs(slopes) + np.abs(measured(scene) / value)
        assert (np.abs((4 * one - two) / 3 - slopes) / sizes).max() < 1e-7, key


def test_units_are_those_of_the_scene() -> None:
    """To round-off: the units of each key, and gravity and radius, which act through time alone."""
    scene = load("gentle-rock")
    known, numbers = derivatives_of(scene).slopes, scene_numbers(scene)
    own, time = sensitivity(problem(scene)), math.sqrt(scene.can.radius / scene.gravity)
    # of the quantity: its unit, and the power of the time in it
    units = {"period": (1.0, 1), "angle_of_turn": (math.degrees(1.0), 0), "peak_psi_dot": (1.0, -1)}
    for name, key in NAMES.items():
        factor, power = units.get(name, (1.0, 0))
        slopes = dict(zip(own.by, own.derivatives[name] * factor * time**power, strict=True))
        for rate in ("phi_dot", "psi_dot", "theta_dot"):
            expected = slopes[rate] * time
            assert known[key][f"release.{rate}"] == pytest.approx(expected, rel=1e-14, abs=0)
        assert known[key]["release.phi"] == pytest.approx(slopes["phi"], rel=1e-14)
        for group in "ach":
            assert known[key][f"can.{group}"] == pytest.approx(slopes[group], rel=1e-14)
        # rates, and 1/time, in proportion to each other and to sqrt(g/R)
        rates = sum(
            numbers[f"release.{rate}"] * (known[key][f"release.{rate}"] or 0.0)
            for rate in ("psi_dot", "theta_dot")
        )
        by_time = power * own.values[name] * factor * time**power + rates
        size = abs(own.values[name] * factor * time**power) + abs(rates)
        by_radius = (known[key]["can.radius"] or 0.0) * scene.can.radius
        by_gravity = (known[key]["gravity"] or 0.0) * scene.gravity
        assert by_radius == pytest.approx(by_time / 2, abs=1e-14 * size)
        assert by_gravity == pytest.approx(-by_time / 2, abs=1e-14 * size)


def test_every_constant_of_a_declared_effect_has_a_key() -> None:
    scene = replace(load("gentle-rock"), effects=EFFECTS["shake"])
    expected = {f"effects.shake.{field.name}" for field in fields(Shake)}
    assert {key for key in scene_numbers(scene) if key.startswith("effects.")} == expected


def test_command() -> None:
    answer = CliRunner().invoke(app, ["reference", "slipping-rock", "--derivatives", "--json"])
    assert answer.exit_code == 0, answer.output
    given = json.loads(answer.stdout)
    assert list(given["derivatives"]) == list(NAMES.values())
    for slopes in given["derivatives"].values():
        assert {"release.phi", "can.radius", "gravity", "effects.slip.mu"} <= set(slopes)
        assert all(isinstance(slope, float) for slope in slopes.values())
    assert given["derivatives_why"] == {}
    plain = CliRunner().invoke(app, ["reference", "slipping-rock", "--json"])
    assert "derivatives" not in json.loads(plain.stdout)


def test_command_says_why_there_is_none() -> None:
    answer = CliRunner().invoke(app, ["reference", "steady-rolling", "--derivatives", "--json"])
    given = json.loads(answer.stdout)
    assert set(given["derivatives_why"]) == set(NAMES.values())
    assert {slope for of in given["derivatives"].values() for slope in of.values()} == {None}
    words = CliRunner().invoke(app, ["reference", "steady-rolling", "--derivatives"]).stdout
    # one reason is told once, and no caveat of what there is not
    assert words.count("the motion has no bounce") == 1
    assert "No derivative of period_s, angle_of_turn_deg" in words
    assert given["derivatives_method"] == "none"
    assert given["derivatives_caveats"] == []


@pytest.mark.parametrize("scene", ["gentle-rock", "slipping-rock"])
def test_columns_of_a_sweep(scene: str) -> None:
    """Of many releases at once, and of scenes with effects one by one, as of the scene itself."""
    names = [
        "d_angle_of_turn_deg/d_release.phi",
        "d_period_s/d_can.radius",
        "d_phi_min_rad/d_gravity",
    ]
    base = load(scene)
    plan = plan_sweep(base, [read_axis("release.phi=0.38:0.4:2")], quantities=names)
    assert plan.exact == (scene == "gentle-rock")
    part = compute(plan, range(2))
    for row, phi in enumerate((0.38, 0.4)):
        own = derivatives_of(scene_at(base, {"release.phi": phi})).slopes
        for name in names:
            quantity, key = (piece.removeprefix("d_") for piece in name.split("/"))
            assert part[name][row] == pytest.approx(own[quantity][key], rel=1e-10)


def test_a_sweep_of_an_engine_has_no_exact_derivative() -> None:
    with pytest.raises(InvalidSettingError, match="of the reference only"):
        plan_sweep(
            load("gentle-rock"),
            [read_axis("release.phi=0.3:0.4:2")],
            engine="mujoco",
            quantities=["d_period_s/d_release.phi"],
        )
