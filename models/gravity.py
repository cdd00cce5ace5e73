"""Gravity in the frame of the plane: tilted with a tilted plane, shaken with a shaken one.

With a point of the plane at u(t) = (horizontal e_d, vertical) sin(w t + phase), w = 2 pi f, a body
falls past the plane with gravity less u''. Who advances by steps needs its mean over a step, which
is exactly what the plane's own velocity loses:

    mean of -u'' over [t, t + dt] = (u'(t) - u'(t + dt))/dt
                                  = w^2 (horizontal e_d, vertical) sin(w (t + dt/2) + phase)
                                    sin(w dt/2)/(w dt/2)

so that the velocity of a can that flies free is exact at the end of each step, however long.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.scene import Scene

Floats = NDArray[np.float64]


def gravity_vector(scene: Scene) -> Floats:
    """Return gravity without the shaking, shape (3,), m/s^2, z along the normal of the plane."""
    tilt = scene.effects.tilt
    if tilt is None:
        return np.array((0.0, 0.0, -scene.gravity))
    along = math.sin(tilt.angle)
    direction = (
        along * math.cos(tilt.direction),
        along * math.sin(tilt.direction),
        -math.cos(tilt.angle),
    )
    return scene.gravity * np.array(direction)


def shaking(scene: Scene, start: ArrayLike, timestep: ArrayLike) -> Floats:
    """Return the part of gravity by the shaking, its mean over a step.

    Parameters
    ----------
    scene : Scene
    start : array_like, shape (...)
        When the step begins, s after the release.
    timestep : array_like, shape (...)
        Its length, s; at zero the mean is the value at `start`.

    Returns
    -------
    ndarray, shape (..., 3)
        m/s^2; zero without shaking.
    """
    start, timestep = np.broadcast_arrays(
        np.asarray(start, dtype=np.float64), np.asarray(timestep, dtype=np.float64)
    )
    shake = scene.effects.shake
    if shake is None:
        return np.zeros((*start.shape, 3))
    rate = 2.0 * math.pi * shake.frequency
    # np.sinc(x) is sin(pi x)/(pi x)
    wave = np.sin(rate * (start + timestep / 2.0) + shake.phase)
    wave = wave * np.sinc(shake.frequency * timestep)
    amplitude = rate**2 * np.array(
        (
            shake.horizontal * math.cos(shake.direction),
            shake.horizontal * math.sin(shake.direction),
            shake.vertical,
        )
    )
    shaken: Floats = wave[..., None] * amplitude
    return shaken


def plane_velocity(scene: Scene, time: ArrayLike) -> Floats:
    """Return the velocity of a shaken plane, shape (..., 3), m/s; zero of one at rest."""
    time = np.asarray(time, dtype=np.float64)
    shake = scene.effects.shake
    if shake is None:
        return np.zeros((*time.shape, 3))
    rate = 2.0 * math.pi * shake.frequency
    amplitude = rate * np.array(
        (
            shake.horizontal * math.cos(shake.direction),
            shake.horizontal * math.sin(shake.direction),
            shake.vertical,
        )
    )
    velocity: Floats = np.cos(rate * time + shake.phase)[..., None] * amplitude
    return velocity
