"""A point of the work-precision diagram: what a case costs, and what it errs."""

import math
import statistics
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from harness.case import Case
from harness.simulation import Outcome
from harness.studies.cost.ladders import Family

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
