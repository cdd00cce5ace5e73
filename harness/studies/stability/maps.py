"""Maps of stability: each run of the hard cases at its timestep, with its verdict.

Of an engine that chooses its own steps the accuracy takes the place of the timestep.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from harness.core.report_model import Figure, Series
from harness.engines.ladder import finer_by
from harness.studies.stability.failure_criteria import ClassifiedRun, StabilityStatus
from harness.studies.stability.limits import axis, case_panels

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

_MAPPED = ("matched", "default")


def map_figures(judged: Sequence[ClassifiedRun], names: Sequence[str]) -> Iterator[Figure]:
    """Yield the stability map of each engine in each profile with a fixed timestep.

    Parameters
    ----------
    judged : sequence of ClassifiedRun
        Of the map; perturbed releases are left out.
    names : sequence of str
        Hard cases, in the order in which they are drawn.
    """
    known = [run for run in judged if run.case.scene.name in names and run.rung]
    for engine in dict.fromkeys(run.case.engine for run in judged):
        for profile in _MAPPED:
            own = [r for r in known if (r.case.engine, r.case.profile) == (engine, profile)]
            if own:
                yield _map(engine, profile, own, names)


def _map(engine: str, profile: str, own: Sequence[ClassifiedRun], names: Sequence[str]) -> Figure:
    """Return one map."""
    steps = [run.rung for run in own]
    ends = (min(steps) / 2.0, max(steps) * 2.0)

    def points(part: Sequence[str]) -> Iterator[Series]:
        for verdict, kind in _KINDS.items():
            runs = [r for r in own if r.verdict is verdict and r.case.scene.name in part]
            yield Series(
                label=verdict.value,
                kind=kind,
                mark="points",
                x=np.array([float(part.index(run.case.scene.name)) for run in runs]),
                y=np.array([run.rung for run in runs]),
                hover=tuple(
                    f"{run.case.scene.name}: {run.symptom.words} {run.symptom.number:.3g} "
                    f"at {run.symptom.time:.3g} s"
                    for run in runs
                ),
            )

    sound = sum(run.sound for run in own)
    accurate = sum(run.accurate for run in own)
    return Figure(
        name=f"map-{engine}-{profile}",
        title=f"Stability map of {engine}, profile {profile}",
        seen=(
            f"Of {len(own)} runs {accurate} follow the exact motion, and in {sound} nothing fails. "
            f"A point is a run: its place says which case and which {finer_by(engine)}, its colour "
            "and mark how it went."
        ),
        panels=case_panels(f"{engine}, {profile}", names, ends, points, axis(engine)),
        columns=1,
    )
