"""For each hard case and engine: up to which timestep runs are accurate, and up to which sound.

Rounds of cases follow from what has been judged so far; whoever runs them hands the verdicts back.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from harness.case import Case
from harness.studies.stability.ensemble import member
from harness.studies.stability.plan import Suite, ladder, scenes
from harness.studies.stability.search import bracket, next_timestep
from harness.studies.stability.verdict import Judged
from models.scene import Scene

STANDARDS = ("accurate", "sound")
"""What usable may mean: it follows the exact motion; or nothing fails, whatever the error."""

PROFILE = "matched"


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit:
    """The largest usable timestep of a case in an engine.

    Parameters
    ----------
    scene, engine, standard : str
    usable : tuple of float or None
        s, of each member of the ensemble; None where no timestep of the ladder is usable.
    coarsest, finest : float
        Ends of the ladder, s.
    """

    scene: str
    engine: str
    standard: str
    usable: tuple[float | None, ...]
    coarsest: float
    finest: float

    @property
    def known(self) -> tuple[float, ...]:
        """The limits there are, s, sorted."""
        return tuple(sorted(step for step in self.usable if step is not None))

    @property
    def middle(self) -> float | None:
        """The median, s, of members with and without a limit; None if most have none."""
        ordered = sorted(-math.inf if step is None else step for step in self.usable)
        found = ordered[(len(ordered) - 1) // 2]
        return found if math.isfinite(found) else None

    @property
    def spread(self) -> float | None:
        """Largest over smallest limit of the members; None if some have none."""
        known = self.known
        return known[-1] / known[0] if known and len(known) == len(self.usable) else None


Known = Mapping[tuple[Scene, str], Sequence[Judged]]
"""Verdicts of profile matched by scene and engine."""


def by_scene(judged: Sequence[Judged]) -> Known:
    """Return verdicts as a search looks for them."""
    found: dict[tuple[Scene, str], list[Judged]] = {}
    for one in judged:
        case = one.simulation.case
        if case.profile == PROFILE:
            found.setdefault((case.scene, case.engine), []).append(one)
    return found


def next_round(suite: Suite, engines: Sequence[str], known: Known) -> tuple[Case, ...]:
    """Return the cases that the searches want to see next, each once; none when all have ended.

    Parameters
    ----------
    suite : Suite
    engines : sequence of str
    known : mapping
        What has been judged so far, the map included.
    """
    wanted: list[Case] = []
    for scene in scenes(suite):
        rungs = ladder(suite, scene)
        for engine in engines:
            for standard in STANDARDS:
                start = _tried(known, scene, engine, standard)
                begin = bracket(start)[0] or rungs[-1]
                for number in range(suite.members):
                    released = member(scene, number)
                    tried = _tried(known, released, engine, standard)
                    step = next_timestep(tried, rungs, suite.ratio, begin)
                    if step is not None:
                        wanted.append(
                            Case(scene=released, engine=engine, profile=PROFILE, timestep=step)
                        )
    return tuple(dict.fromkeys(wanted))


def limits(suite: Suite, engines: Sequence[str], known: Known) -> tuple[Limit, ...]:
    """Return the largest usable timesteps, from what the searches found."""
    return tuple(
        Limit(
            scene=scene.name,
            engine=engine,
            standard=standard,
            usable=tuple(
                bracket(_tried(known, member(scene, number), engine, standard))[0]
                for number in range(suite.members)
            ),
            coarsest=ladder(suite, scene)[0],
            finest=ladder(suite, scene)[-1],
        )
        for scene in scenes(suite)
        for engine in engines
        for standard in STANDARDS
    )


def _tried(known: Known, scene: Scene, engine: str, standard: str) -> dict[float, bool]:
    """Return which timesteps of a release were tried, s, and whether each was usable."""
    return {
        one.simulation.case.timestep: getattr(one, standard)
        for one in known.get((scene, engine), ())
        if one.simulation.case.timestep is not None
    }
