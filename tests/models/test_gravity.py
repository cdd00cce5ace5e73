"""Gravity in the frame of a tilted and of a shaken plane."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from models import Effects, Scene, Shake, Tilt, load
from models.gravity import gravity_vector, plane_velocity, shaking

SHAKE = Shake(frequency=15.0, horizontal=5e-4, vertical=3e-4, direction=0.7, phase=0.4)


def scene(**effects: Any) -> Scene:
    return replace(load("gentle-rock"), effects=Effects(**effects))


def displacement(t: float) -> np.ndarray:
    """Return where the plane of SHAKE is, from the definition of the effect."""
    wave = math.sin(2.0 * math.pi * SHAKE.frequency * t + SHAKE.phase)
    across = SHAKE.horizontal * np.array((math.cos(0.7), math.sin(0.7), 0.0))
    return np.asarray(wave * (across + np.array((0.0, 0.0, SHAKE.vertical))))


def test_a_level_plane_has_plain_gravity() -> None:
    np.testing.assert_array_equal(gravity_vector(scene()), (0.0, 0.0, -9.81))


@pytest.mark.parametrize(("angle", "direction"), [(0.05, 0.0), (0.3, 2.0), (1.5, -1.0)])
def test_a_tilted_plane_pulls_down_its_slope(angle: float, direction: float) -> None:
    found = gravity_vector(scene(tilt=Tilt(angle=angle, direction=direction)))
    # an angle and a direction are turned into components and back: a few roundings
    assert np.linalg.norm(found) == pytest.approx(9.81, rel=4e-16, abs=0)
    assert math.acos(-found[2] / 9.81) == pytest.approx(angle, rel=1e-12, abs=0)
    assert math.atan2(found[1], found[0]) == pytest.approx(direction, rel=1e-15, abs=0)


@pytest.mark.parametrize("timestep", [1e-6, 1e-3, 0.05, 1.0 / 15.0, 0.2])
def test_the_mean_over_a_step_is_the_integral_of_the_planes_acceleration(timestep: float) -> None:
    shaken, rate = scene(shake=SHAKE), 2.0 * math.pi * SHAKE.frequency
    for start in (0.0, 0.0123):
        mean = [
            quad(lambda t, i=i: rate**2 * displacement(t)[i], start, start + timestep)[0] / timestep
            for i in range(3)
        ]
        largest = rate**2 * 5e-4
        # quad promises 1.5e-8; over a whole period the mean is round-off
        np.testing.assert_allclose(
            shaking(shaken, start, timestep), mean, atol=1e-8 * largest, rtol=0
        )


def test_what_gravity_gains_is_what_the_planes_velocity_loses() -> None:
    shaken, timestep = scene(shake=SHAKE), 1e-3
    times = timestep * np.arange(200)
    gained = np.cumsum(shaking(shaken, times, timestep), axis=0) * timestep
    expected = plane_velocity(shaken, 0.0) - plane_velocity(shaken, times + timestep)
    # 200 additions of numbers of 0.05
    np.testing.assert_allclose(gained, expected, atol=200 * 2e-16 * 0.05, rtol=0)


def test_the_planes_velocity_is_the_rate_of_its_displacement() -> None:
    shaken, h = scene(shake=SHAKE), 1e-6
    for t in (0.0, 0.017, 0.3):
        slope = (displacement(t + h) - displacement(t - h)) / (2.0 * h)
        # central difference: (rate h)^2/6 of the velocity, and an ulp of 5e-4 over h
        np.testing.assert_allclose(plane_velocity(shaken, t), slope, atol=1e-10, rtol=0)


def test_a_plane_at_rest_adds_nothing() -> None:
    still = scene(tilt=Tilt(angle=0.1))
    np.testing.assert_array_equal(shaking(still, np.arange(3.0), 0.1), np.zeros((3, 3)))
    np.testing.assert_array_equal(plane_velocity(still, np.arange(3.0)), np.zeros((3, 3)))
