"""Random cans and releases on which the reference is tried.

Cans from disks to rods and releases from 1e-9 rad to nearly pi/2 are drawn evenly in their
logarithms, some rates exactly zero, in SI units with masses, radii and gravities over many decades.
"""

import math
from collections.abc import Iterator

import numpy as np

from models.can import Can
from models.scene import Horizon, Scene
from models.state import Release

_SEED = 20_230_208


def random_scenes(count: int) -> Iterator[Scene]:
    """Yield so many scenes, the same every time."""
    random = np.random.default_rng(_SEED)
    for number in range(count):
        yield _scene(random, number)


def _scene(random: np.random.Generator, number: int) -> Scene:
    """Return one random scene of one bounce."""

    def decades(low: float, high: float) -> float:
        return float(10.0 ** random.uniform(low, high))

    def rate() -> float:
        kind = random.integers(5)
        size = 0.0 if kind == 0 else decades(-10.0, 1.5)
        return float(random.choice((-1.0, 1.0))) * size

    h, a = decades(-2.0, 1.0), decades(-1.5, 1.5)
    can = Can.from_groups(
        mass=decades(-6.0, 6.0),
        radius=decades(-3.0, 1.0),
        a=a,
        c=a * random.uniform(1e-3, 2.0),
        h=h,
    )
    shape = random.integers(3)
    if shape == 0:
        phi = decades(-9.0, -0.5)
    elif shape == 1:
        phi = can.balancing_angle * (1.0 - decades(-5.0, -0.5))
    else:
        phi = random.uniform(0.01, 0.99) * math.pi / 2.0
    moving = random.integers(3) == 0
    psi, theta = rate(), rate()
    if random.integers(3) == 0:
        theta = -psi  # no spin: what is left of a bounce when the turn is all there is
    gravity = decades(-5.0, 3.0)
    unit = math.sqrt(can.radius / gravity)
    return Scene(
        name=f"random-{number}",
        gravity=gravity,
        can=can,
        release=Release(
            phi=float(phi),
            phi_dot=float(random.choice((-1.0, 1.0))) * decades(-10.0, 1.5) / unit
            if moving
            else 0.0,
            psi_dot=psi / unit,
            theta_dot=theta / unit,
        ),
        horizon=Horizon(bounces=1),
    )
