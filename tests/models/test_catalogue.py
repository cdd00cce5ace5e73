"""The catalogue: what is in it, and that its scenes are what their citations say."""

import math
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models import (
    Can,
    Horizon,
    Scene,
    SceneFileError,
    UnknownSceneError,
    load,
    names,
    release_state,
    write_scene,
)

PAPER_CAN = Can.from_groups(mass=0.043, radius=0.037, a=0.727, c=0.615, h=1.473)
PANELS = ("paper-release", "petals", "wobble", "cusps")  # a, b, c, d of fig01:contact_pt_motion

WITH_EFFECTS = {
    "chaotic-can": ("shake", "point_mass"),
    "dropped-can": ("slip", "restitution"),
    "euler-disk": ("slip", "contour_friction"),
    "falls-flat": ("restitution",),
    "off-centre-mass": ("point_mass",),
    "shaken-plane": ("shake",),
    "slipping-rock": ("slip",),
    "soft-rock": ("compliance",),
    "thrown-up": ("slip", "restitution", "shake"),
    "tilted-plane": ("tilt",),
}


def test_the_catalogue_has_the_scenes_it_promises() -> None:
    assert names() == (
        "chaotic-can",
        "cusps",
        "dropped-can",
        "euler-disk",
        "falls-flat",
        "gentle-rock",
        "off-centre-mass",
        "paper-release",
        "petals",
        "shaken-plane",
        "slipping-rock",
        "soft-rock",
        "steady-rolling",
        "straight-rolling",
        "thrown-up",
        "tilted-plane",
        "wobble",
    )


@pytest.mark.parametrize("name", names())
def test_a_scene_is_named_after_its_file_and_cites_its_source(name: str) -> None:
    scene = load(name)
    assert scene.name == name
    sources = ("arXiv:2302.08335", "Phys. Rev. E 78, 066609", "Nature 404 (2000) 833")
    assert any(source in scene.cite for source in sources)
    assert (scene.can == PAPER_CAN) == (name != "euler-disk")
    assert scene.gravity == 9.81
    assert scene.effects.declared() == WITH_EFFECTS.get(name, ())


def test_the_papers_releases_are_in_radians_per_second() -> None:
    found = [load(name).release for name in PANELS]
    balancing = math.atan2(1.0, 1.473)
    assert [(r.phi, r.psi_dot, r.theta_dot) for r in found] == [
        (math.pi / 100, 0.1001, -0.1),
        (pytest.approx(balancing - 1e-5, abs=1e-16), 0.0, 2.0),  # an ulp of 0.6
        (math.pi / 100, 0.72667, 7.0),
        (math.pi / 100, 1.7267, 7.0),
    ]
    assert all((r.psi, r.theta, r.phi_dot) == (0.0, 0.0, 0.0) for r in found)


def balance(scene: Scene) -> np.ndarray:
    """Return dH/dt - GP x force about G, over m g R, for constant phi, psi' and theta'.

    Newton-Euler in the frame that precesses with the can, with no equation of the paper's in it.
    """
    can, release = scene.can, scene.release
    R, H, phi = can.radius, can.half_height, release.phi
    s, c = math.sin(phi), math.cos(phi)
    axis = np.array((-s, 0.0, c))  # of symmetry, in the intermediate frame
    across = np.array((c, 0.0, s))
    turning = np.array((0.0, 0.0, release.psi_dot))
    omega = turning + release.theta_dot * axis
    contact = -R * across - H * axis
    velocity = np.cross(contact, omega)
    momentum = can.axial_inertia * (omega @ axis) * axis
    momentum = momentum + can.transverse_inertia * (omega @ across) * across
    weight = np.array((0.0, 0.0, scene.gravity))
    force = can.mass * (np.cross(turning, velocity) + weight)
    torque = np.cross(contact, force)
    return (np.cross(turning, momentum) - torque) / (can.mass * scene.gravity * R)


@pytest.mark.parametrize("name", ["steady-rolling", "straight-rolling"])
def test_a_steady_motion_balances_to_round_off(name: str) -> None:
    # Terms of size (psi' + theta')^2 R/g, up to 2, cancel: each rounded a few times, and the
    # release itself is rounded once.
    assert np.abs(balance(load(name))).max() <= 16 * np.finfo(np.float64).eps


def test_steady_rolling_turns_twice_on_circles_that_are_not_points() -> None:
    scene = load("steady-rolling")
    release, R = scene.release, scene.can.radius
    assert scene.horizon == Horizon(seconds=4.0 * math.pi / release.psi_dot)
    assert release.phi < 0.6 * scene.can.balancing_angle
    _, twist = release_state(scene.can, release)
    radius = np.linalg.norm(twist.velocity) / release.psi_dot
    assert round(radius / R, 3) == 0.116
    assert round(abs(release.theta_dot / release.psi_dot), 3) == 0.636
    # the friction ratio is the centripetal acceleration over g
    assert round(radius * release.psi_dot**2 / scene.gravity, 3) == 0.175


def growth(scene: Scene) -> float:
    """Return d phi''/d phi over g/R along the first integrals of a steady motion.

    The linearised motion about it is phi'' = growth phi; Psi and Theta follow phi by
    (eq01:psi_diff_phi, eq01:theta_diff_phi), phi'' by (eq01:Phi).
    """
    a, c, h = scene.can.a, scene.can.c, scene.can.h
    a_p, c_p = a + h**2, c + 1.0
    k = c / (a + c * a_p)
    unit = math.sqrt(scene.can.radius / scene.gravity)
    phi, Psi, Theta = (
        scene.release.phi,
        *(unit * rate for rate in (scene.release.psi_dot, scene.release.theta_dot)),
    )
    sin, cos = math.sin(phi), math.cos(phi)
    Psi_phi = (k * c_p * Theta + ((k * c_p - 2) * cos - h * k * sin) * Psi) / sin
    Theta_phi = (
        (-k * c_p * cos + h * k * sin) * Theta
        + (-k * c_p * cos**2 - k * a_p * sin**2 + h * k * math.sin(2 * phi) + 2) * Psi
    ) / sin

    def acceleration(step: float) -> float:
        p, P, T = phi + step, Psi + step * Psi_phi, Theta + step * Theta_phi
        s, c_ = math.sin(p), math.cos(p)
        return (
            ((a_p - c_p) * s * c_ - h * math.cos(2 * p)) * P**2
            - (c_p * s + h * c_) * T * P
            + h * s
            - c_
        ) / (a_p + 1)

    step = 1e-5  # error step^2 and eps/step: 1e-10 either way, of numbers of size one
    return (acceleration(step) - acceleration(-step)) / (2 * step)


def test_steady_rolling_is_stable() -> None:
    assert round(math.sqrt(-growth(load("steady-rolling"))), 2) == 1.34


def test_straight_rolling_is_above_the_critical_rate_and_the_papers_formula_is_not_it() -> None:
    scene = load("straight-rolling")
    assert scene.release.psi_dot == 0.0
    # an ulp of 0.6: the can's H is rounded, the file's angle was computed from h itself
    assert scene.release.phi == pytest.approx(scene.can.balancing_angle, abs=2e-16, rel=0)

    def at(rate: float) -> float:
        return growth(replace(scene, release=replace(scene.release, theta_dot=rate)))

    assert at(scene.release.theta_dot) < 0.0
    assert at(17.749) < 0.0 < at(17.747)  # the scene file's 17.748 rad/s
    assert at(16.190) > 0.0  # just above what the paper's formula gives: it still falls


def test_petals_start_beside_an_unstable_balance() -> None:
    scene = load("petals")
    rate = math.sqrt(growth(scene) * scene.gravity / scene.can.radius)
    assert round(rate, 1) == 10.9


def test_an_unknown_scene_lists_what_there_is() -> None:
    with pytest.raises(UnknownSceneError) as caught:
        load("gentle-rok")
    assert (caught.value.name, caught.value.available) == ("gentle-rok", tuple(names()))
    assert str(caught.value) == (
        f"unknown scene 'gentle-rok', did you mean 'gentle-rock'? it is neither in the catalogue "
        f"({', '.join(names())}) nor the path of a scene file"
    )


def test_capital_letters_are_no_other_name() -> None:
    with pytest.raises(UnknownSceneError, match="did you mean 'paper-release'"):
        load("Paper-Release")


@pytest.mark.parametrize("name", ["", ".", "..", "x" * 5000, "a\0b", "gentle-rock\n"])
def test_no_odd_name_is_taken_for_a_scene_or_a_file(name: str) -> None:
    with pytest.raises(UnknownSceneError):
        load(name)


@pytest.mark.parametrize("kind", [str, Path])
def test_a_path_is_read_whatever_it_is_called(tmp_path: Path, kind: type) -> None:
    path = tmp_path / "my scene"
    path.write_text(write_scene(load("wobble")))
    assert load(kind(path)) == load("wobble")


def test_a_name_of_the_catalogue_comes_before_a_file_beside_you(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("wobble").write_text("nothing")
    assert load("wobble").name == "wobble"
    with pytest.raises(SceneFileError):
        load(f".{os.sep}wobble")


def test_what_looks_like_a_path_and_is_none_is_a_missing_file() -> None:
    with pytest.raises(SceneFileError) as caught:
        load("nowhere.toml")
    assert caught.value.path == Path("nowhere.toml")
    assert caught.value.problems == ("there is no such file",)
