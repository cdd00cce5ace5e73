"""The stability study in words: a summary, and one page an engine."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence

from harness.core.report_model import Prose
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
