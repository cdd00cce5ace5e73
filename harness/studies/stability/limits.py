"""For each hard case and engine: up to which timestep runs are accurate, and up to which sound.

Of an engine that chooses its own steps its accuracy takes the place of the timestep throughout.

Rounds of cases follow from what has been judged so far; whoever runs them hands the verdicts back.

The largest usable timestep, by bisection in log dt, as rounds: a study designs and never runs.

A search is what is known of a release so far: which timesteps were usable. What to try next follows
from that alone. The boundary is ragged (whether a step happens to fall into the bounce decides), so
that a timestep may be usable by luck far above others that are not, and by round-off not be usable
far below; the boundary sought is the upper end of the longest unbroken run of usable timesteps.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise, product

import numpy as np

from harness.core.case import Case
from harness.core.report_model import Column, Figure, Panel, Series, Table, table_of
from harness.engines.base import TIMESTEP
from harness.engines.ladder import at_rung, finer_by, rung_of, spelled, takes_timestep
from harness.studies.shared.perturbation import member
from harness.studies.stability.failure_criteria import ClassifiedRun
from harness.studies.stability.suite import Suite, ladder, represented
from models.scene import Scene

_SAME = 1e-9  # relative: timesteps nearer than that are one


def bracket(known: Mapping[float, bool]) -> tuple[float | None, float | None]:
    """Return the largest usable timestep and the smallest above it that is not, s.

    Parameters
    ----------
    known : mapping of float to bool
        Timesteps that were tried, s, and whether each was usable.

    Returns
    -------
    usable : float or None
        None if none was usable.
    unusable : float or None
        None if none above the usable one was tried in vain; if none was usable, the smallest.
    """
    runs: list[list[float]] = []
    unbroken = False
    for step in sorted(known):
        if known[step] and unbroken:
            runs[-1].append(step)
        elif known[step]:
            runs.append([step])
        unbroken = known[step]
    if not runs:
        return None, min(known, default=None)
    best = max(runs, key=lambda run: (run[-1] / run[0], -run[0]))
    return best[-1], min((step for step in known if step > best[-1]), default=None)


def next_timestep(
    known: Mapping[float, bool], rungs: Sequence[float], ratio: float, start: float
) -> float | None:
    """Return the timestep to try next, s; None if the boundary is known, or is not on the ladder.

    Parameters
    ----------
    known : mapping of float to bool
    rungs : sequence of float
        Ladder along which a bracket is looked for, s.
    ratio : float
        Unusable over usable timestep from which on the boundary counts as known.
    start : float
        Where to begin, s.
    """
    if not known:
        return start
    usable, unusable = bracket(known)
    if usable is None:
        lower = min(known)
        return max((rung for rung in rungs if rung < lower * (1.0 - _SAME)), default=None)
    if unusable is None:
        return min((rung for rung in rungs if rung > usable * (1.0 + _SAME)), default=None)
    if unusable <= ratio * usable:
        return None
    return math.sqrt(usable * unusable)


STANDARDS = ("accurate", "sound")
"""Meanings of usable: the run follows the exact motion; or nothing fails, whatever the error."""

PROFILE = "matched"


@dataclass(frozen=True, slots=True, kw_only=True)
class TimestepLimit:
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
        value = ordered[(len(ordered) - 1) // 2]
        return value if math.isfinite(value) else None

    @property
    def spread(self) -> float | None:
        """Largest over smallest limit of the members; None if a member has no limit."""
        known = self.known
        return known[-1] / known[0] if known and len(known) == len(self.usable) else None


Known = Mapping[tuple[Scene, str], Sequence[ClassifiedRun]]
"""Verdicts of profile matched by scene and engine."""


def by_scene(judged: Sequence[ClassifiedRun]) -> Known:
    """Return verdicts as a search looks for them."""
    groups: dict[tuple[Scene, str], list[ClassifiedRun]] = {}
    for run in judged:
        case = run.case
        if case.profile == PROFILE:
            groups.setdefault((case.scene, case.engine), []).append(run)
    return groups


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
    for (scene, engine), standard in product(represented(suite, engines), STANDARDS):
        rungs = ladder(suite, scene, engine)
        begin = bracket(_tried(known, scene, engine, standard))[0] or rungs[-1]
        for number in range(suite.members):
            released = member(scene, number)
            tried = _tried(known, released, engine, standard)
            step = next_timestep(tried, rungs, suite.ratio, begin)
            if step is not None:
                wanted.append(at_rung(_plain(released, engine), step))
    return tuple(dict.fromkeys(wanted))


def foreseen_cases(suite: Suite, engines: Sequence[str], known: Known) -> tuple[Case, ...]:
    """Return as many cases as the searches will want after the next round, about as fine.

    A search halves the logarithm of its bracket each time. One without a bracket is expected to
    find it between two rungs: before anything is known in the middle of the ladder.
    """
    foreseen: list[Case] = []
    for (scene, engine), standard in product(represented(suite, engines), STANDARDS):
        rungs = ladder(suite, scene, engine)
        widest = max(a / b for a, b in pairwise(rungs)) if len(rungs) > 1 else 1.0
        for number in range(suite.members):
            released = member(scene, number)
            tried = _tried(known, released, engine, standard)
            usable, unusable = bracket(tried)
            if tried and next_timestep(tried, rungs, suite.ratio, rungs[-1]) is None:
                continue
            begin, end = usable or unusable or rungs[len(rungs) // 2], unusable or usable
            width = end / begin if usable and unusable and end else widest
            count = math.ceil(math.log2(max(math.log(width) / math.log(suite.ratio), 1.0)))
            count += 0 if usable and unusable else 1
            foreseen += [  # each a little apart, so that none is taken for another
                at_rung(_plain(released, engine), begin * (1 + 1e-9 * n))
                for n in range(1 if tried else 0, count)
            ]
    return tuple(dict.fromkeys(foreseen))


def limits(suite: Suite, engines: Sequence[str], known: Known) -> tuple[TimestepLimit, ...]:
    """Return the largest usable timesteps, given the results of the searches."""
    return tuple(
        TimestepLimit(
            scene=scene.name,
            engine=engine,
            standard=standard,
            usable=tuple(
                bracket(_tried(known, member(scene, number), engine, standard))[0]
                for number in range(suite.members)
            ),
            coarsest=ladder(suite, scene, engine)[0],
            finest=ladder(suite, scene, engine)[-1],
        )
        for (scene, engine), standard in product(represented(suite, engines), STANDARDS)
    )


def _tried(known: Known, scene: Scene, engine: str, standard: str) -> dict[float, bool]:
    """Return which timesteps of a release were tried, s, and whether each was usable."""
    return {
        rung: getattr(run, standard)
        for run in known.get((scene, engine), ())
        if (rung := rung_of(run.case)) is not None
    }


def _plain(scene: Scene, engine: str) -> Case:
    """Return the case of a release before its timestep is chosen."""
    return Case(scene=scene, engine=engine, profile=PROFILE)


_LIMITS = (
    Column("scene", "Name of the hard case."),
    Column("engine", "Name of the engine, profile matched."),
    Column("accurate_timestep_s", "Largest that follows the exact motion, median of releases."),
    Column("accurate_spread", "Largest over smallest of the releases; empty if some have none."),
    Column("accurate_releases", "Of how many releases some timestep is accurate."),
    Column("sound_timestep_s", "Largest timestep at which nothing fails, median of releases."),
    Column("sound_spread", "Largest over smallest of the releases; empty if some have none."),
    Column("sound_releases", "Of how many releases some timestep is sound."),
    Column("finest_s", "Finest timestep that was tried."),
    Column("coarsest_s", "Coarsest timestep tried: a limit that equals it may lie beyond."),
    Column("accurate_accuracy", "Of an engine that chooses its own steps, as the timestep above."),
    Column("sound_accuracy", "Likewise."),
    Column("finest_accuracy", "Finest accuracy that was tried.", shown=False),
    Column("coarsest_accuracy", "Coarsest accuracy that was tried.", shown=False),
)


def limit_table(largest: Sequence[TimestepLimit]) -> Table:
    """Return the largest usable timesteps, a row a case and engine."""
    rows: dict[tuple[str, str], dict[str, object]] = {}
    for limit in largest:
        row = rows.setdefault((limit.scene, limit.engine), {})
        steps = takes_timestep(limit.engine)
        row |= {
            "scene": limit.scene,
            "engine": limit.engine,
            f"{limit.standard}_{'timestep_s' if steps else 'accuracy'}": limit.middle,
            f"{limit.standard}_spread": limit.spread,
            f"{limit.standard}_releases": len(limit.known),
            f"finest_{'s' if steps else 'accuracy'}": limit.finest,
            f"coarsest_{'s' if steps else 'accuracy'}": limit.coarsest,
        }
    title = "The largest usable timestep"
    return table_of("largest-timesteps", title, _LIMITS, rows.values())


def limit_sentence(limits: Sequence[TimestepLimit]) -> str:
    """Return between which timesteps the limits of an engine lie."""
    known = sorted(
        (limit.middle, limit.scene)
        for limit in limits
        if limit.standard == "accurate" and limit.middle is not None
    )
    if not known:
        along = finer_by(limits[0].engine) if limits else TIMESTEP
        return f"No hard case is followed at any {along} that was tried."
    (least, hardest), (most, easiest) = known[0], known[-1]
    engine = limits[0].engine
    return (
        f"Matched, the largest {finer_by(engine)} that follows the exact motion lies between "
        f"{spelled(engine, least)} ({hardest}) and {spelled(engine, most)} ({easiest}) in the "
        f"{len(known)} cases that have one."
    )


_WIDE = 18
"""Most cases in a panel whose names can still be read."""


def case_panels(
    title: str,
    names: Sequence[str],
    ends: tuple[float, float],
    series: Callable[[Sequence[str]], Iterable[Series]],
    y_label: str = "timestep [s]",
) -> tuple[Panel, ...]:
    """Return panels of timesteps over hard cases, as many as can be read, about as wide each.

    Parameters
    ----------
    title : str
    names : sequence of str
        Of the cases, in the order in which they are drawn.
    ends : tuple of 2 floats
        Of the axis of timesteps, s.
    series : callable
        Returns the series of a part of the cases.
    y_label : str
    """
    size = -(-len(names) // -(-len(names) // _WIDE))
    parts = [names[start : start + size] for start in range(0, len(names), size)]
    return tuple(
        Panel(
            title=title,
            x_label="hard case",
            y_label=y_label,
            series=tuple(series(part)),
            log_y=True,
            x_names=tuple(part),
            y_range=ends,
        )
        for part in parts
    )


def axis(engine: str) -> str:
    """Return the label of an axis of timesteps, or of the accuracies in their place."""
    return "timestep [s]" if takes_timestep(engine) else finer_by(engine)


def limit_figures(limits: Sequence[TimestepLimit], names: Sequence[str]) -> Iterator[Figure]:
    """Yield the figure of the limits of timesteps, and one of those of each kind of accuracy."""
    for along in dict.fromkeys(finer_by(limit.engine) for limit in limits):
        yield _limit_figure([each for each in limits if finer_by(each.engine) == along], names)


def _limit_figure(limits: Sequence[TimestepLimit], names: Sequence[str]) -> Figure:
    """Return the largest timesteps that are accurate and that are sound, a point a release."""
    along, y_label = finer_by(limits[0].engine), axis(limits[0].engine)
    ends = (min(limit.finest for limit in limits), 2.0 * max(limit.coarsest for limit in limits))

    def points(standard: str, part: Sequence[str]) -> Iterator[Series]:
        for engine in dict.fromkeys(limit.engine for limit in limits):
            pairs = [
                (float(part.index(limit.scene)), step)
                for limit in limits
                if (limit.engine, limit.standard) == (engine, standard) and limit.scene in part
                for step in limit.known
            ]
            x, y = np.array(pairs).reshape(-1, 2).T
            yield Series(label=engine, kind=engine, x=x, y=y, mark="points")

    accurate, sound = (partial(points, standard) for standard in STANDARDS)
    return Figure(
        name="limits" if along == TIMESTEP else f"limits-{along}",
        title=f"The largest usable {along}",
        seen=(
            f"Profile matched, found by bisection for {len(limits[0].usable)} releases that differ "
            "by a thousandth: where their points lie apart the boundary is ragged. A case without "
            f"a point is not usable at any {along} that was tried."
        ),
        panels=(
            *case_panels(
                f"Largest {along} that follows the exact motion", names, ends, accurate, y_label
            ),
            *case_panels(f"Largest {along} at which nothing fails", names, ends, sound, y_label),
        ),
        columns=1,
    )
