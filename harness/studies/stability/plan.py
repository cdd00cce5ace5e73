"""What is run: the map, a grid of timesteps for each hard case, engine and profile."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from harness.case import Case
from models.catalogue import hard_names, load
from models.scene import Scene

_QUICK = (
    "balance-1e-5",
    "drop-1-cm",
    "epsilon-1e-04",
    "epsilon-1e-08",
    "epsilon-1e-24",
    "euler-disk",
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

    scenes: tuple[str, ...]
    timesteps: tuple[float, ...]
    most_steps: int
    members: int
    ratio: float
    random_scenes: int


SUITES = {
    "quick": Suite(
        scenes=_QUICK,
        timesteps=(2e-2, 5e-3, 1e-3, 2e-4, 5e-5),
        most_steps=10_000,
        members=2,
        ratio=1.25,
        random_scenes=200,
    ),
    "full": Suite(
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


def ladder(suite: Suite, scene: Scene) -> tuple[float, ...]:
    """Return the timesteps of a scene, s, from coarse to fine: neither too few steps nor too many.

    Parameters
    ----------
    suite : Suite
    scene : Scene
        With a horizon in seconds, as every hard case.
    """
    seconds = scene.horizon.seconds or 0.0
    return tuple(
        step
        for step in suite.timesteps
        if _FEWEST_STEPS * step <= seconds <= step * suite.most_steps
    )


def scenes(suite: Suite) -> tuple[Scene, ...]:
    """Return the scenes of a suite."""
    return tuple(load(name) for name in suite.scenes)


def design(suite: Suite, engines: Sequence[str]) -> tuple[Case, ...]:
    """Return the cases of the map, coarse timesteps of a scene first.

    Parameters
    ----------
    suite : Suite
    engines : sequence of str
        That take a timestep.
    """
    return tuple(
        case for scene in scenes(suite) for engine in engines for case in _row(suite, scene, engine)
    )


def _row(suite: Suite, scene: Scene, engine: str) -> Iterator[Case]:
    """Yield the cases of a scene in an engine: its own timestep as shipped, adaptive, the grid."""
    yield Case(scene=scene, engine=engine, profile="default")
    for profile in ("default", "matched"):
        for timestep in ladder(suite, scene):
            yield Case(scene=scene, engine=engine, profile=profile, timestep=timestep)
    yield Case(scene=scene, engine=engine, profile="adaptive")
