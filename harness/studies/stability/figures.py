"""The stability map, a run a point, coloured by verdict; and the largest usable timesteps."""

from collections.abc import Iterator, Sequence

import numpy as np

from harness.core.report_model import Figure, Panel, Series
from harness.studies.stability.failure_criteria import ClassifiedRun, StabilityStatus
from harness.studies.stability.limits import TimestepLimit

_KINDS = {
    StabilityStatus.ACCURATE: "verdict-2",
    StabilityStatus.STABLE: "verdict-2",
    StabilityStatus.INACCURATE: "verdict-4",
    StabilityStatus.UNRESOLVED: "verdict-1",
    StabilityStatus.DISSIPATES: "verdict-3",
    StabilityStatus.FLAT: "verdict-3",
    StabilityStatus.GAINS: "verdict-5",
    StabilityStatus.TUNNELS: "verdict-5",
    StabilityStatus.DIVERGES: "verdict-6",
    StabilityStatus.REFUSED: "verdict-6",
}
"""Verdicts of one colour; two of a colour differ in their marks."""

_WIDE = 18
"""Cases beside each other in a panel whose names can still be read."""

_PROFILES = ("matched", "default")


def map_figures(judged: Sequence[ClassifiedRun], names: Sequence[str]) -> tuple[Figure, ...]:
    """Return the stability map of each engine in each profile with a fixed timestep.

    Parameters
    ----------
    judged : sequence of Judged
        Of the map; perturbed releases are left out.
    names : sequence of str
        Hard cases, in the order in which they are drawn.
    """
    engines = dict.fromkeys(one.case.engine for one in judged)
    figures = []
    for engine in engines:
        for profile in _PROFILES:
            own = [
                one
                for one in judged
                if (one.case.engine, one.case.profile) == (engine, profile)
                and one.case.scene.name in names
                and one.simulation.timestep is not None
            ]
            if own:
                figures.append(_map(engine, profile, own, names))
    return tuple(figures)


def _map(engine: str, profile: str, own: Sequence[ClassifiedRun], names: Sequence[str]) -> Figure:
    """Return one map."""
    steps = [one.simulation.timestep or np.nan for one in own]
    ends = (min(steps) / 2.0, max(steps) * 2.0)
    panels = [
        Panel(
            title=f"{engine}, {profile}",
            x_label="hard case",
            y_label="timestep [s]",
            series=tuple(_series(own, part)),
            log_y=True,
            x_names=tuple(part),
            y_range=ends,
        )
        for part in _parts(names)
    ]
    sound = sum(one.sound for one in own)
    accurate = sum(one.verdict is StabilityStatus.ACCURATE for one in own)
    return Figure(
        name=f"map-{engine}-{profile}",
        title=f"Stability map of {engine}, profile {profile}",
        seen=(
            f"Of {len(own)} runs {accurate} follow the exact motion, and in {sound} nothing fails. "
            "A point is a run: its place says which case and which timestep, its colour and mark "
            "how it went."
        ),
        panels=tuple(panels),
        columns=1,
    )


def _series(own: Sequence[ClassifiedRun], names: Sequence[str]) -> Iterator[Series]:
    """Yield the points of each verdict."""
    places = {name: place for place, name in enumerate(names)}
    for verdict, kind in _KINDS.items():
        points = [one for one in own if one.verdict is verdict and one.case.scene.name in places]
        yield Series(
            label=verdict.value,
            kind=kind,
            mark="points",
            x=np.array([float(places[one.case.scene.name]) for one in points]),
            y=np.array([one.simulation.timestep or np.nan for one in points]),
            hover=tuple(
                f"{one.case.scene.name}: {one.symptom.words} {one.symptom.number:.3g} "
                f"at {one.symptom.time:.3g} s"
                for one in points
            ),
        )


def _parts(names: Sequence[str]) -> list[Sequence[str]]:
    """Return names in as many parts as there must be panels, about as long each."""
    size = -(-len(names) // -(-len(names) // _WIDE))
    return [names[start : start + size] for start in range(0, len(names), size)]


def limit_figure(limits: Sequence[TimestepLimit], names: Sequence[str]) -> Figure:
    """Return the largest timesteps that are accurate and that are sound, a point a release."""
    ends = (min(limit.finest for limit in limits), 2.0 * max(limit.coarsest for limit in limits))
    panels = [
        Panel(
            title=title,
            x_label="hard case",
            y_label="timestep [s]",
            series=tuple(_limits_of(limits, standard, part)),
            log_y=True,
            x_names=tuple(part),
            y_range=ends,
        )
        for standard, title in (
            ("accurate", "Largest timestep that follows the exact motion"),
            ("sound", "Largest timestep at which nothing fails"),
        )
        for part in _parts(names)
    ]
    return Figure(
        name="limits",
        title="The largest usable timestep",
        seen=(
            f"Profile matched, found by bisection for {len(limits[0].usable)} releases that differ "
            "by a thousandth: where their points lie apart the boundary is ragged. A case without "
            "a point is not usable at any timestep that was tried."
        ),
        panels=tuple(panels),
        columns=1,
    )


def _limits_of(
    limits: Sequence[TimestepLimit], standard: str, names: Sequence[str]
) -> Iterator[Series]:
    """Yield the points of each engine."""
    for engine in dict.fromkeys(limit.engine for limit in limits):
        pairs = [
            (float(names.index(limit.scene)), step)
            for limit in limits
            if (limit.engine, limit.standard) == (engine, standard) and limit.scene in names
            for step in limit.known
        ]
        x, y = np.array(pairs).reshape(-1, 2).T
        yield Series(label=engine, kind=engine, x=x, y=y, mark="points")
