"""A family of runs: one choice of settings of an engine, from coarse to fine."""

import math
from dataclasses import dataclass

from harness.case import Case
from harness.engines.reference import truth
from harness.engines.registry import timestep_of
from harness.engines.schedule import ETA
from harness.engines.variants import Variant
from models.scene import Scene

_A_TURN = 5.0
"""rad of precession in the coarsest step at its fastest: nearly a turn, so the bounce is missed."""

_LONGEST = 1e-3
"""s: beyond it a can of some centimetres falls visibly in a step."""

RUNGS = {
    "tuning": (1.0, 0.3, 0.1, 0.03),
    "quick": (1.0, 0.3, 0.1, 0.03, 0.01),
    "full": (1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001),
}
"""Timesteps over the coarsest one: two decades, or three; to choose settings one and a half."""

SHARES = {
    "tuning": (8.0, 4.0, 2.0, 1.0, 0.5),
    "quick": (32.0, 8.0, 2.0, 1.0, 0.25),
    "full": (64.0, 32.0, 16.0, 8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125),
}
"""Adaptive: eta and the largest step together, over their own choice; two decades and more."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Family:
    """Runs that differ in how fine they are alone.

    Parameters
    ----------
    variant : Variant
    cases : tuple of Case
        From coarse to fine.
    """

    variant: Variant
    cases: tuple[Case, ...]

    @property
    def engine(self) -> str:
        """The engine of all of them."""
        return self.cases[0].engine

    @property
    def scene(self) -> Scene:
        """The scene of all of them."""
        return self.cases[0].scene

    @property
    def name(self) -> str:
        """What tables call it."""
        return self.variant.name

    @property
    def steps(self) -> bool:
        """Whether the ladder is one of timesteps."""
        return self.variant.along == "timestep"


def timesteps(scene: Scene, suite: str) -> tuple[float, ...]:
    """Return the timesteps of a suite for a scene, from coarse to fine, s.

    The coarsest is a power of ten, so that rows of different scenes can be compared.
    """
    rate = max((abs(bounce.peak_psi_dot) for bounce in truth(scene).bounces), default=0.0)
    longest = _LONGEST if rate == 0.0 else min(_LONGEST, _A_TURN / rate)
    coarsest = round(math.log10(longest))
    return tuple(float(f"{share * 10.0**coarsest:.3g}") for share in RUNGS[suite])


def family(scene: Scene, name: str, variant: Variant, suite: str) -> Family:
    """Return a variant of an engine as a ladder."""

    def case(timestep: float | None, *further: tuple[str, object]) -> Case:
        options = tuple((dict(variant.settings) | dict(further)).items())
        return Case(
            scene=scene,
            engine=name,
            profile=variant.profile,
            timestep=timestep,
            options=options,  # type: ignore[arg-type]
        )

    if variant.along == "timestep" and variant.profile == "adaptive":
        largest = timestep_of(case(None)) or _LONGEST
        return Family(
            variant=variant,
            cases=tuple(case(largest * share, ("eta", ETA * share)) for share in SHARES[suite]),
        )
    if variant.along == "timestep":
        steps = set(timesteps(scene, suite))
        if variant.profile == "default" and not variant.settings:
            shipped = timestep_of(case(None))
            steps |= set() if shipped is None else {shipped}
        return Family(variant=variant, cases=tuple(map(case, sorted(steps, reverse=True))))
    if variant.along:
        return Family(
            variant=variant,
            cases=tuple(case(None, (variant.along, value)) for value in variant.values),
        )
    return Family(variant=variant, cases=(case(None),))
