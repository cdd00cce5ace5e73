"""A point of the work-precision diagram: cost and errors of a case, and how it is run.

A family of runs: one choice of settings of an engine, from coarse to fine.
"""

import math
import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from harness.core.case import Case, Value
from harness.core.simulation import Outcome
from harness.engines.base import Variant
from harness.engines.ladder import finer_by, rung_of, takes_timestep
from harness.engines.reference.truth import truth
from harness.engines.registry import is_constraint, timestep_of
from harness.engines.stepping.schedule import ETA
from harness.evaluation.case_record import lost_errors, measured
from harness.evaluation.effort import engine_group, expected_seconds
from harness.evaluation.evaluate import check_case
from harness.evaluation.evaluation import Record
from harness.evaluation.timing import overhead
from harness.metrics.convergence import pareto_front
from harness.studies.study import Work, record_cache
from models.scene import Scene

_A_TURN = 5.0
"""rad of precession in the coarsest step at its fastest: nearly a turn, so the bounce is missed."""

LONGEST = 1e-3
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
    def name(self) -> str:
        """What tables call it."""
        return self.variant.name

    @property
    def steps(self) -> bool:
        """Whether the ladder is one of timesteps, or of accuracies of an engine's own steps."""
        return self.variant.along == finer_by(self.engine)


def timesteps(scene: Scene, suite: str) -> tuple[float, ...]:
    """Return the timesteps of a suite for a scene, from coarse to fine, s.

    The coarsest is a power of ten, so that rows of different scenes can be compared.
    """
    rate = max((abs(bounce.peak_psi_dot) for bounce in truth(scene).bounces), default=0.0)
    longest = LONGEST if rate == 0.0 else min(LONGEST, _A_TURN / rate)
    coarsest = round(math.log10(longest))
    return tuple(float(f"{share * 10.0**coarsest:.3g}") for share in RUNGS[suite])


def family(scene: Scene, name: str, variant: Variant, suite: str) -> Family:
    """Return a variant of an engine as a ladder."""
    if variant.along == "timestep" and variant.profile == "adaptive":
        return adaptive_family(scene, name, variant, SHARES[suite])
    if variant.along == "timestep":
        steps = set(timesteps(scene, suite))
        if variant.profile == "default" and not variant.settings:
            shipped = timestep_of(_case(scene, name, variant))
            steps |= set() if shipped is None else {shipped}
        cases = [_case(scene, name, variant, step) for step in sorted(steps, reverse=True)]
    elif variant.along:
        cases = [_case(scene, name, variant, None, (variant.along, v)) for v in variant.values]
    else:
        cases = [_case(scene, name, variant)]
    return Family(variant=variant, cases=tuple(cases))


def adaptive_family(scene: Scene, name: str, variant: Variant, shares: Sequence[float]) -> Family:
    """Return a ladder whose timesteps follow the motion.

    Parameters
    ----------
    scene : Scene
    name : str
        Of the engine.
    variant : Variant
    shares : sequence of float
        Of eta and of the largest step together, over their own choice, from coarse to fine.
    """
    largest = timestep_of(_case(scene, name, variant)) or LONGEST
    cases = [_case(scene, name, variant, largest * share, ("eta", ETA * share)) for share in shares]
    return Family(variant=variant, cases=tuple(cases))


def _case(
    scene: Scene,
    name: str,
    variant: Variant,
    timestep: float | None = None,
    *further: tuple[str, Value],
) -> Case:
    options = tuple((dict(variant.settings) | dict(further)).items())
    return Case(
        scene=scene, engine=name, profile=variant.profile, timestep=timestep, options=options
    )


def hard_command(case: Case) -> str:
    """Return the command of a case whose scene file the study wrote next to its report."""
    name = case.scene.name
    return case.command().replace(name, f"scenes/{name}.toml", 1)


def _manifest(case: Case, record: Record) -> Record:
    """Return the entry of a run in the manifest."""
    return {
        "digest": case.digest(record["version"]),
        "label": case.label(),
        "command": record["command"],
        "engine": case.engine,
        "engine_version": record["version"],
        "outcome": Outcome[record["outcome"]].value,
    }


MEASURING: Work[Case, Record] = Work(
    name="errors",
    call=measured,
    lost=lost_errors,
    label=Case.label,
    cache=record_cache("errors", measured.__module__),
    check=check_case,
    effort=expected_seconds,
    group=engine_group,
    manifest=_manifest,
)
"""Run a case and return its errors and counts, without the motion."""

HARD_MEASURING: Work[Case, Record] = replace(
    MEASURING,
    manifest=lambda case, record: _manifest(case, record | {"command": hard_command(case)}),
)
"""The same of a scene that the study makes: its command names a scene file next to the report."""

OVERHEAD: Work[Case, Record] = Work(
    name="overhead",
    call=overhead,
    lost=lambda case, error: {"ways": {}},  # noqa: ARG005 - one that does not come back has none
    label=Case.label,
    alone=True,
)
"""Time a step of one free body."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Point:
    """A case with its errors and its times.

    Parameters
    ----------
    case : Case
    variant : Variant
        The settings of its family.
    run : Record
        What `MEASURING` left of the error run.
    timed : Record, optional
        What `TIMING` left; where the case was not to be timed alone, the times of the error run
        stand in.
    """

    case: Case
    variant: Variant
    run: Record = field(repr=False)
    timed: Record | None = None

    @property
    def times(self) -> Record:
        """Processor and clock seconds of each repeat, and those of the set-up."""
        if self.timed is not None:
            return self.timed
        own = self.run["cpu_s"]
        return {"cpu_s": [own] if own else [], "wall_s": [], "setup_s": self.run["setup_s"]}

    @property
    def outcome(self) -> Outcome:
        """How the run ended."""
        return Outcome[self.run["outcome"]]

    @property
    def timestep(self) -> float | None:
        """The timestep, s; the largest of an adaptive run; None for a solver of its own steps."""
        step: float | None = self.run["timestep_s"]
        return step

    @property
    def rung(self) -> float | None:
        """The timestep, s, or the accuracy of own steps; None of a solver without either."""
        return self.timestep if takes_timestep(self.case.engine) else rung_of(self.case)

    @property
    def digest(self) -> str:
        """What names the case."""
        return self.case.digest(self.run["version"])

    @property
    def cost(self) -> float:
        """Least processor seconds per simulated second; infinite where it was not measured."""
        return self._per_simulated_second(min)

    @property
    def median(self) -> float:
        """Median of the same."""
        return self._per_simulated_second(statistics.median)

    def _per_simulated_second(self, of: Callable[[list[float]], float]) -> float:
        seconds, simulated = self.times["cpu_s"], self.run["simulated_s"]
        return of(seconds) / simulated if seconds and simulated else math.inf

    @property
    def spread(self) -> float:
        """How far the median lies above the minimum, over the minimum."""
        return self.median / self.cost - 1.0 if math.isfinite(self.cost) else math.nan

    @property
    def noise(self) -> float:
        """How far the second least of the repeats lies above the least, over it."""
        least = sorted(self.times["cpu_s"])[:2]
        return least[1] / least[0] - 1.0 if len(least) > 1 and least[0] > 0.0 else math.nan

    @property
    def waiting(self) -> float | None:
        """Seconds by the clock over processor seconds: above 1 the machine was busy otherwise."""
        cpu, wall = sum(self.times["cpu_s"]), self.times["wall_s"]
        return sum(wall) / cpu if wall and cpu else None

    def error(self, name: str) -> float:
        """Return the magnitude of an error; infinite where it failed or is not known."""
        value = self.signed_error(name)
        return math.inf if value is None else abs(value)

    def signed_error(self, name: str) -> float | None:
        """Return an error, engine minus truth; None where the run failed or it is not known."""
        value: float | None = self.run["errors"].get(name)
        return value if self.outcome is Outcome.FINISHED else None


def fronts(points: Sequence[Point], target: str) -> tuple[tuple[Point, ...], tuple[Point, ...]]:
    """Return the points that no other beats in cost and error: of contacts, and of constraints.

    An engine that imposes rolling solves another problem, and beats none that has contacts.
    """
    ranked: list[tuple[Point, ...]] = []
    for apart in (False, True):
        own = [p for p in points if is_constraint(p.case.engine) is apart]
        places = pareto_front([p.cost for p in own], [p.error(target) for p in own])
        ranked.append(tuple(own[place] for place in places))
    contacts, constraints = ranked
    return contacts, constraints
