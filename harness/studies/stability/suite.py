"""What is run: the map, a grid of timesteps for each hard case, engine and profile.

Random cans and releases on which the reference is tried.

Cans from disks to rods and releases from 1e-9 rad to nearly pi/2 are drawn evenly in their
logarithms, some rates exactly zero, in SI units with masses, radii and gravities over many decades.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from harness.core.case import Case
from harness.engines.ladder import at_rung, rungs, takes_timestep
from harness.engines.registry import missing_effects
from models.can import Can
from models.catalogue import hard_names, load
from models.release import Release
from models.scene import Horizon, Scene

_QUICK = (
    "balance-1e-5",
    "drop-1-cm",
    "epsilon-1e-04",
    "epsilon-1e-08",
    "epsilon-1e-24",
    "euler-disk-early",
    "free-tumbling",
    "hundred-g",
    "needle-moments",
    "planar-fall",
    "spinning-cylinder",
    "start-in-penetration",
    "tall-can",
    "tiny-can",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Suite:
    """How much is run.

    Parameters
    ----------
    name : str
    scenes : tuple of str
        Names of hard cases.
    timesteps : tuple of float
        s, from coarse to fine.
    most_steps : int
        In a run; finer timesteps of a case are left out.
    members : int
        Releases for which the largest usable timestep is sought: that of the scene and perturbed
        ones, for the boundary is ragged.
    ratio : float
        Of the timesteps, one usable and one not, between which a search may end.
    random_scenes : int
        On which the reference is tried.
    """

    name: str
    scenes: tuple[str, ...]
    timesteps: tuple[float, ...]
    most_steps: int
    members: int
    ratio: float
    random_scenes: int


SUITES = {
    "quick": Suite(
        name="quick",
        scenes=_QUICK,
        timesteps=(2e-2, 5e-3, 1e-3, 2e-4, 5e-5),
        most_steps=10_000,
        members=2,
        ratio=1.25,
        random_scenes=200,
    ),
    "full": Suite(
        name="full",
        scenes=hard_names(),
        timesteps=(
            *(2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5),
            *(5e-6, 2e-6, 1e-6, 1e-7, 1e-8),
        ),
        most_steps=200_000,
        members=3,
        ratio=1.05,
        random_scenes=10_000,
    ),
}
"""quick: about two minutes on two cores. full: every hard case, down to what time allows."""

_FEWEST_STEPS = 4
"""In a run: with fewer there is nothing to judge."""


def ladder(suite: Suite, scene: Scene, engine: str = "") -> tuple[float, ...]:
    """Return the timesteps of a scene, s, from coarse to fine: neither too few steps nor too many.

    Parameters
    ----------
    suite : Suite
    scene : Scene
        With a horizon in seconds, as every hard case.
    engine : str, optional
        One that chooses its own steps has accuracies in the place of timesteps.
    """
    seconds = scene.horizon.seconds or 0.0
    timesteps = tuple(
        step
        for step in suite.timesteps
        if _FEWEST_STEPS * step <= seconds <= step * suite.most_steps
    )
    return rungs(engine, timesteps)


def scenes(suite: Suite) -> tuple[Scene, ...]:
    """Return the scenes of a suite."""
    return tuple(load(name) for name in suite.scenes)


def represented(suite: Suite, engines: Sequence[str]) -> Iterator[tuple[Scene, str]]:
    """Yield each hard case with each of the engines that can represent it."""
    for scene, engine in product(scenes(suite), engines):
        if not missing_effects(engine, scene):
            yield scene, engine


def stability_cases(suite: Suite, engines: Sequence[str]) -> tuple[Case, ...]:
    """Return the cases of the map, coarse timesteps of a scene first.

    Parameters
    ----------
    suite : Suite
    engines : sequence of str
    """
    return tuple(
        case for scene, engine in represented(suite, engines) for case in _row(suite, scene, engine)
    )


def _row(suite: Suite, scene: Scene, engine: str) -> Iterator[Case]:
    """Yield the cases of a scene in an engine: its own timestep as shipped, the grid, adaptive."""
    shipped = Case(scene=scene, engine=engine, profile="default")
    yield shipped
    for case in (shipped, replace(shipped, profile="matched")):
        for value in ladder(suite, scene, engine):
            yield at_rung(case, value)
    if takes_timestep(engine):
        yield replace(shipped, profile="adaptive")


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
