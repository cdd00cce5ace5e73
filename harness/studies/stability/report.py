"""The report of the stability study: a summary, one page an engine, the map, largest timesteps."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from harness.core.report_model import Figure, Panel, Prose, Series
from harness.studies.stability.failure_criteria import (
    MEANINGS,
    ClassifiedRun,
    StabilityStatus,
    Symptom,
)
from harness.studies.stability.limits import TimestepLimit
from harness.studies.stability.survey import ReferenceCheck

_PROFILES = {
    "default": "As it ships",
    "matched": "Matched to the scene",
    "adaptive": "With steps that follow the motion",
}


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
    engines = dict.fromkeys(one.case.engine for one in judged)
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
    judged : sequence of Judged
        Of the map.
    limits : sequence of Limit
    names : sequence of str
        Of the hard cases.
    """
    own = [one for one in judged if one.case.engine == engine and one.case.scene.name in names]
    paragraphs = [
        _counted(own, profile, words)
        for profile, words in _PROFILES.items()
        if any(one.case.profile == profile for one in own)
    ]
    paragraphs.append(_steps([limit for limit in limits if limit.engine == engine]))
    paragraphs.append(" ".join(_cures(own, names)))
    return Prose(
        name=f"verdict-{engine}", title=f"The verdict on {engine}", text="\n\n".join(paragraphs)
    )


def _counted(own: Sequence[ClassifiedRun], profile: str, words: str) -> str:
    """Return how the runs of a profile went, and an example of each failure."""
    runs = [one for one in own if one.case.profile == profile]
    counts = Counter(one.verdict for one in runs)
    told = ", ".join(
        f"{verdict.value} {counts[verdict]}" for verdict in StabilityStatus if counts[verdict]
    )
    examples = []
    for verdict in StabilityStatus:
        failed = [one for one in runs if one.verdict is verdict and not one.sound]
        if failed:
            # at the finest timestep at which it happens, where it is least to be expected
            one = min(failed, key=lambda one: one.simulation.timestep or 0.0)
            step = one.simulation.timestep or 0.0
            examples.append(
                f"{_VERBS.get(verdict, verdict.value)} in {one.case.scene.name} down to "
                f"a timestep of {step:.2g} s ({seen(one.symptom)})"
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


def _steps(limits: Sequence[TimestepLimit]) -> str:
    """Return between which timesteps its limits lie."""
    known = sorted(
        (limit.middle, limit.scene)
        for limit in limits
        if limit.standard == "accurate" and limit.middle is not None
    )
    if not known:
        return "No hard case is followed at any timestep that was tried."
    (least, hardest), (most, easiest) = known[0], known[-1]
    return (
        f"Matched, the largest timestep that follows the exact motion lies between {least:.2g} s "
        f"({hardest}) and {most:.2g} s ({easiest}) in the {len(known)} cases that have one."
    )


def _cures(own: Sequence[ClassifiedRun], names: Sequence[str]) -> list[str]:
    """Return for each case that fails as shipped what cures it, if anything does."""
    cured: dict[str, list[str]] = {}
    for name in names:
        runs = [one for one in own if one.case.scene.name == name]
        shipped = next((one for one in runs if _as_shipped(one)), None)
        if shipped is None or shipped.good:
            continue
        cured.setdefault(_cure(runs, shipped), []).append(f"{name} ({shipped.verdict.value})")
    return [f"{cure}: {', '.join(cases)}." for cure, cases in sorted(cured.items())]


def _as_shipped(one: ClassifiedRun) -> bool:
    case = one.case
    return case.profile == "default" and case.timestep is None


def _cure(runs: Sequence[ClassifiedRun], shipped: ClassifiedRun) -> str:
    """Return the setting that makes a case good, the simplest first."""
    best: Mapping[str, float] = {
        profile: max(
            (
                one.simulation.timestep or 0.0
                for one in runs
                if one.case.profile == profile and one.good
            ),
            default=0.0,
        )
        for profile in _PROFILES
    }
    if best["default"]:
        than = "shorter" if best["default"] < (shipped.simulation.timestep or 0.0) else "longer"
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

_WIDE = 18
"""Cases beside each other in a panel whose names can still be read."""

_MAPPED = ("matched", "default")


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
        for profile in _MAPPED:
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
