"""The report of the stability study: a summary, one page an engine, the map, every run."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from harness.core.report_model import Artefact, Column, Figure, Prose, Series, Table, table_of
from harness.studies.shared.run_columns import ENGINE, OUTCOME, run_cells, without
from harness.studies.stability.failure_criteria import (
    MEANINGS,
    SOUND,
    ClassifiedRun,
    StabilityStatus,
    Symptom,
)
from harness.studies.stability.limits import (
    TimestepLimit,
    case_panels,
    limit_figure,
    limit_sentence,
    limit_table,
)
from harness.studies.stability.suite import Suite
from harness.studies.stability.survey import ReferenceCheck, case_table, survey_table


def stability_report(
    suite: Suite,
    runs: Sequence[ClassifiedRun],
    limits: Sequence[TimestepLimit],
    hard: Sequence[ReferenceCheck],
    random: Sequence[ReferenceCheck],
) -> tuple[Artefact, ...]:
    """Return words, maps and tables.

    Parameters
    ----------
    suite : Suite
    runs : sequence of ClassifiedRun
        Of the map and of the searches.
    limits : sequence of TimestepLimit
    hard, random : sequence of ReferenceCheck
        How the reference fares on the hard cases and on random scenes.
    """
    on_grid = [run for run in runs if run.case.timestep in {None, *suite.timesteps}]
    engines = dict.fromkeys(limit.engine for limit in limits)
    return (
        summary(runs, hard, random),
        *(engine_page(engine, on_grid, limits, suite.scenes) for engine in engines),
        *map_figures(on_grid, suite.scenes),
        limit_figure(limits, suite.scenes),
        limit_table(limits),
        case_table(hard),
        survey_table(random),
        _run_table(runs),
    )


_PROFILES = (
    ("default", "As it ships"),
    ("matched", "Matched to the scene"),
    ("adaptive", "With steps that follow the motion"),
)


_VERBS = {StabilityStatus.UNRESOLVED: "is unresolved", StabilityStatus.REFUSED: "is refused"}
"""What an engine is said to do where the verdict is no verb."""

_UNITS = {"rad", "m/s", "s"}
"""Units in which the words of a symptom may end."""


def summary(
    judged: Sequence[ClassifiedRun],
    hard: Sequence[ReferenceCheck],
    random: Sequence[ReferenceCheck],
) -> Prose:
    """Return the summary: counts, and how the reference fared."""
    engines = dict.fromkeys(run.case.engine for run in judged)
    solved = sum(not finding.failure and not finding.refusal for finding in hard)
    refused = sum(bool(finding.refusal) for finding in hard)
    failed = [finding for finding in hard if finding.failure]
    unsure = sum(bool(finding.refusal) for finding in random)
    wrong = sum(bool(finding.failure) for finding in random)
    sentences = [
        f"{len(judged)} runs of {' and '.join(engines)} over {len(hard)} hard cases were judged.",
        (
            f"The reference solves {solved} of the hard cases to 1e-9 in two ways that agree, and "
            f"refuses {refused} with a sentence."
        ),
        *(f"It fails on {finding.scene}: {finding.failure}." for finding in failed),
        f"Of {len(random)} random scenes it refuses {unsure} and fails on {wrong}.",
    ]
    meanings = "; ".join(f"{verdict.value}: {MEANINGS[verdict]}" for verdict in StabilityStatus)
    text = " ".join(sentences) + f"\n\nThe verdicts are {meanings}."
    return Prose(name="summary", title="Hard cases stay numerically stable", text=text)


def engine_page(
    engine: str,
    judged: Sequence[ClassifiedRun],
    limits: Sequence[TimestepLimit],
    names: Sequence[str],
) -> Prose:
    """Return the one-page verdict on an engine.

    Parameters
    ----------
    engine : str
    judged : sequence of ClassifiedRun
        Of the map.
    limits : sequence of TimestepLimit
    names : sequence of str
        Of the hard cases.
    """
    own = [run for run in judged if run.case.engine == engine and run.case.scene.name in names]
    paragraphs = [
        *(_counted(runs, words) for profile, words in _PROFILES if (runs := _of(own, profile))),
        limit_sentence([limit for limit in limits if limit.engine == engine]),
        " ".join(_cures(own, names)),
    ]
    return Prose(
        name=f"verdict-{engine}", title=f"The verdict on {engine}", text="\n\n".join(paragraphs)
    )


def _of(own: Sequence[ClassifiedRun], profile: str) -> list[ClassifiedRun]:
    """Return the runs of a profile."""
    return [run for run in own if run.case.profile == profile]


def _counted(runs: Sequence[ClassifiedRun], words: str) -> str:
    """Return how the runs of a profile went, and an example of each failure."""
    by_verdict = {v: [run for run in runs if run.verdict is v] for v in StabilityStatus}
    told = ", ".join(f"{v.value} {len(found)}" for v, found in by_verdict.items() if found)
    examples = []
    for verdict, found in by_verdict.items():
        if found and verdict not in SOUND:
            # at the finest timestep at which it happens, where it is least to be expected
            run = min(found, key=lambda run: run.timestep)
            examples.append(
                f"{_VERBS.get(verdict, verdict.value)} in {run.case.scene.name} down to "
                f"a timestep of {run.timestep:.2g} s ({seen(run.symptom)})"
            )
    tail = f" It {'; it '.join(examples)}." if examples else ""
    return f"{words}, {len(runs)} runs: {told}.{tail}"


def seen(symptom: Symptom) -> str:
    """Return a symptom as a person says it: what was seen, how much of it, and when."""
    if math.isnan(symptom.number):
        return symptom.words
    words, _, unit = symptom.words.rpartition(", ")
    much = f"{symptom.number:.2g}"
    told = f"{words} {much} {unit}" if words and unit in _UNITS else f"{symptom.words} {much}"
    return f"{told}, at {symptom.time:.2g} s"


def _cures(own: Sequence[ClassifiedRun], names: Sequence[str]) -> list[str]:
    """Return for each case that fails as shipped what cures it, if anything does."""
    cured: dict[str, list[str]] = {}
    for name in names:
        runs = [run for run in own if run.case.scene.name == name]
        shipped = next((run for run in _of(runs, "default") if run.case.timestep is None), None)
        if shipped is not None and not shipped.good:
            cured.setdefault(_cure(runs, shipped), []).append(f"{name} ({shipped.verdict.value})")
    return [f"{cure}: {', '.join(cases)}." for cure, cases in sorted(cured.items())]


def _cure(runs: Sequence[ClassifiedRun], shipped: ClassifiedRun) -> str:
    """Return the setting that makes a case good, the simplest first."""
    best = {
        profile: max((run.timestep for run in _of(runs, profile) if run.good), default=0.0)
        for profile, _ in _PROFILES
    }
    if best["default"]:
        than = "shorter" if best["default"] < shipped.timestep else "longer"
        return f"Cured by a {than} timestep alone, at {best['default']:.0e} s"
    if best["matched"]:
        return f"Cured by profile matched at {best['matched']:.0e} s"
    if best["adaptive"]:
        return "Cured by profile adaptive"
    return "Cured by nothing that was tried"


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
    known = [run for run in judged if run.case.scene.name in names and run.timestep]
    for engine in dict.fromkeys(run.case.engine for run in judged):
        for profile in _MAPPED:
            own = [run for run in _of(known, profile) if run.case.engine == engine]
            if own:
                yield _map(engine, profile, own, names)


def _map(engine: str, profile: str, own: Sequence[ClassifiedRun], names: Sequence[str]) -> Figure:
    """Return one map."""
    steps = [run.timestep for run in own]
    ends = (min(steps) / 2.0, max(steps) * 2.0)

    def points(part: Sequence[str]) -> Iterator[Series]:
        for verdict, kind in _KINDS.items():
            runs = [r for r in own if r.verdict is verdict and r.case.scene.name in part]
            yield Series(
                label=verdict.value,
                kind=kind,
                mark="points",
                x=np.array([float(part.index(run.case.scene.name)) for run in runs]),
                y=np.array([run.timestep for run in runs]),
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
            "A point is a run: its place says which case and which timestep, its colour and mark "
            "how it went."
        ),
        panels=case_panels(f"{engine}, {profile}", names, ends, points),
        columns=1,
    )


_RUNS = (
    Column("scene", "Name of the hard case, or of a release perturbed from it."),
    ENGINE,
    Column("profile", "default: as it ships; matched: as the scene declares; adaptive: own steps."),
    Column("timestep_s", "Timestep of the engine; the largest of an adaptive run."),
    Column("verdict", "How the run went, by the criteria of the study."),
    Column("number", "The number behind the verdict."),
    Column("number_is", "What the number is."),
    Column("time_s", "When it was seen first, or was largest."),
    OUTCOME,
    Column("steps", "Timesteps taken."),
    Column("case", "Digest of the case; its command is in the list of cases."),
)


def _run_table(runs: Sequence[ClassifiedRun]) -> Table:
    """Return every run and its verdict."""
    rows = [
        run_cells(run.simulation)
        | {
            "verdict": run.verdict.value,
            "number": run.symptom.number,
            "number_is": run.symptom.words,
            "time_s": run.symptom.time,
            "outcome": run.simulation.outcome.value.partition(":")[0],
        }
        for run in runs
    ]
    return table_of("verdicts", "Every run and its verdict", without(_RUNS, "outcome"), rows)
