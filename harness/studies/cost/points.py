"""A point of the work-precision diagram: what a case costs, and what it errs.

A family of runs: one choice of settings of an engine, from coarse to fine.
"""

import math
import statistics
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from harness.core.case import Case
from harness.core.simulation import Outcome
from harness.engines.base import Variant
from harness.engines.reference.truth import truth
from harness.engines.registry import timestep_of
from harness.engines.stepping.schedule import ETA
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


Record = Mapping[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Point:
    """A case with its errors and its times.

    Parameters
    ----------
    case : Case
    family : str
    outcome : Outcome
    version : str
    timestep : float or None
        s.
    errors : mapping of str to float or None
        Engine minus truth, by name.
    cpu : tuple of float
        Processor seconds of each repeat; empty if it was not timed.
    wall : tuple of float
    setup : float or None
        s.
    simulated : float or None
        s.
    steps, rows : int
    iterations : float or None
    imposes : str
        What the settings make of the can beyond the scene.
    note : str
    command : str
        Runs the case again.
    """

    case: Case
    family: str
    outcome: Outcome
    version: str
    timestep: float | None
    errors: Mapping[str, float | None] = field(repr=False)
    cpu: tuple[float, ...] = ()
    wall: tuple[float, ...] = ()
    setup: float | None = None
    simulated: float | None = None
    steps: int = 0
    rows: int = 0
    iterations: float | None = None
    imposes: str = ""
    note: str = ""
    command: str = ""

    @property
    def digest(self) -> str:
        """What names the case."""
        return self.case.digest(self.version)

    @property
    def cost(self) -> float:
        """Least processor seconds per simulated second; infinite where it was not measured."""
        return min(self.cpu) / self.simulated if self.cpu and self.simulated else math.inf

    @property
    def median(self) -> float:
        """Median of the same."""
        return (
            statistics.median(self.cpu) / self.simulated
            if self.cpu and self.simulated
            else math.inf
        )

    @property
    def spread(self) -> float:
        """How far the median lies above the minimum, over the minimum."""
        return self.median / self.cost - 1.0 if math.isfinite(self.cost) else math.nan

    @property
    def noise(self) -> float:
        """How far the second least of the repeats lies above the least, over it."""
        least = sorted(self.cpu)[:2]
        return least[1] / least[0] - 1.0 if len(least) > 1 and least[0] > 0.0 else math.nan

    def error(self, name: str) -> float:
        """Return the magnitude of an error; infinite where it failed or is not known."""
        value = self.errors.get(name)
        return math.inf if value is None or self.outcome is not Outcome.FINISHED else abs(value)


def point(case: Case, family: Family, error: Record, time: Record | None) -> Point:
    """Return a point from what the error run and the timing run left.

    Without a timing run the time of the error run stands in.
    """
    return Point(
        case=case,
        family=family.name,
        outcome=Outcome[error["outcome"]],
        version=error["version"],
        timestep=error["timestep_s"],
        errors=error["errors"],
        cpu=tuple(time["cpu_s"]) if time else (error["cpu_s"],) if error["cpu_s"] else (),
        wall=tuple(time["wall_s"]) if time else (),
        setup=time["setup_s"] if time else error["setup_s"],
        simulated=error["simulated_s"],
        steps=error["steps"],
        rows=error["constraint_rows"],
        iterations=error["solver_iterations"],
        imposes=family.variant.imposes,
        note=error["note"],
        command=error["command"],
    )
