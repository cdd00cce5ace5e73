"""Which engines are probed with which settings: as they ship, and matched, each once."""

from collections.abc import Sequence

from harness.case import Case
from models.catalogue import load

PROFILES = ("default", "matched")
"""Adaptive is matched with other timesteps, and probes take one timestep."""

SCENE = "gentle-rock"
"""Whose can and gravity are probed; the release is each probe's own."""


def design(
    engines: Sequence[str], profiles: Sequence[str] = PROFILES, timestep: float | None = None
) -> tuple[Case, ...]:
    """Return the cases to measure.

    Parameters
    ----------
    engines : sequence of str
        Names of engines that step a world.
    profiles : sequence of str
    timestep : float, optional
        s; each profile's own if left out.
    """
    scene = load(SCENE)
    return tuple(
        Case(scene=scene, engine=engine, profile=profile, timestep=timestep)
        for engine in engines
        for profile in profiles
    )
