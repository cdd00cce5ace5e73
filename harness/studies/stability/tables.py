"""The tables of the stability study: every run, the largest usable timesteps, the reference."""

import math
from collections.abc import Mapping, Sequence

import pandas as pd

from harness.core.report_model import Table
from harness.studies.stability.failure_criteria import ClassifiedRun
from harness.studies.stability.limits import TimestepLimit
from harness.studies.stability.survey import ALLOWED, ReferenceCheck
from models.catalogue import load

_RUNS: Mapping[str, str] = {
    "scene": "Name of the hard case, or of a release perturbed from it.",
    "engine": "Name of the engine.",
    "profile": "default: as it ships; matched: what the scene declares; adaptive: and own steps.",
    "timestep_s": "Timestep of the engine; the largest of an adaptive run.",
    "verdict": "How the run went, by the criteria of the study.",
    "number": "The number behind the verdict.",
    "number_is": "What the number is.",
    "time_s": "When it was seen first, or was largest.",
    "outcome": "How the run ended.",
    "steps": "Timesteps taken.",
    "case": "Digest of the case; its command is in the list of cases.",
}


def run_table(judged: Sequence[ClassifiedRun]) -> Table:
    """Return every run and its verdict."""
    rows = []
    for one in judged:
        s = one.simulation
        rows.append(
            {
                "scene": s.case.scene.name,
                "engine": s.case.engine,
                "profile": s.case.profile,
                "timestep_s": s.timestep,
                "verdict": one.verdict.value,
                "number": one.sign.number,
                "number_is": one.sign.words,
                "time_s": one.sign.time,
                "outcome": s.outcome.value.partition(":")[0],
                "steps": s.steps,
                "case": s.case.digest(s.engine_version),
            }
        )
    return Table(
        name="verdicts",
        title="Every run and its verdict",
        frame=pd.DataFrame(rows, columns=list(_RUNS)),
        columns=_RUNS,
        shown=tuple(name for name in _RUNS if name != "outcome"),
    )


_LIMITS: Mapping[str, str] = {
    "scene": "Name of the hard case.",
    "engine": "Name of the engine, profile matched.",
    "accurate_timestep_s": "Largest timestep that follows the exact motion, median of releases.",
    "accurate_spread": "Largest over smallest of the releases; empty where some have none.",
    "accurate_releases": "Of how many releases some timestep is accurate.",
    "sound_timestep_s": "Largest timestep at which nothing fails, median of releases.",
    "sound_spread": "Largest over smallest of the releases; empty where some have none.",
    "sound_releases": "Of how many releases some timestep is sound.",
    "finest_s": "Finest timestep that was tried.",
    "coarsest_s": "Coarsest timestep that was tried: a limit that equals it may lie beyond.",
}


def limit_table(limits: Sequence[TimestepLimit]) -> Table:
    """Return the largest usable timesteps, a row a case and engine."""
    rows: dict[tuple[str, str], dict[str, object]] = {}
    for limit in limits:
        row = rows.setdefault(
            (limit.scene, limit.engine), {"scene": limit.scene, "engine": limit.engine}
        )
        row |= {
            f"{limit.standard}_timestep_s": limit.middle,
            f"{limit.standard}_spread": limit.spread,
            f"{limit.standard}_releases": len(limit.known),
            "finest_s": limit.finest,
            "coarsest_s": limit.coarsest,
        }
    return Table(
        name="largest-timesteps",
        title="The largest usable timestep",
        frame=pd.DataFrame(list(rows.values()), columns=list(_LIMITS)),
        columns=_LIMITS,
    )


_CASES: Mapping[str, str] = {
    "scene": "Name of the hard case.",
    "why": "Why it is hard, and where it comes from.",
    "reference": "What the reference makes of it.",
    "disagreement": "Largest relative difference of formula and integration.",
    "energy_error": "Largest change of energy over what the can has to spend.",
    "evaluations": "Evaluations of the equations that the integration needed.",
}


def case_table(findings: Sequence[ReferenceCheck]) -> Table:
    """Return the hard cases, why they are hard, and how the reference fares."""
    rows = [
        {
            "scene": finding.scene,
            "why": load(finding.scene).cite.removeprefix("Hard because "),
            "reference": finding.failure
            or (f"refused: {finding.refusal}" if finding.refusal else f"solved: {finding.outcome}"),
            "disagreement": math.nan if finding.refusal else finding.disagreement,
            "energy_error": math.nan if finding.refusal else finding.energy_error,
            "evaluations": None if finding.refusal else finding.evaluations,
        }
        for finding in findings
    ]
    return Table(
        name="hard-cases",
        title="The hard cases, and the reference on each",
        frame=pd.DataFrame(rows, columns=list(_CASES)),
        columns=_CASES,
    )


_SURVEY: Mapping[str, str] = {
    "ends": "How the motion ends.",
    "scenes": "How many random scenes.",
    "failures": "How many of them failed.",
    "ill_conditioned": "In how many one ulp of the input does more than 1e-9: these are refused.",
    "largest_disagreement": "Of formula and integration, relative.",
    "largest_energy_error": "Over what the can has to spend.",
    "most_evaluations": "Of the equations, in one bounce.",
}


def survey_table(findings: Sequence[ReferenceCheck]) -> Table:
    """Return how the reference fared on random scenes, by how they end."""
    groups: dict[str, list[ReferenceCheck]] = {}
    for finding in findings:
        groups.setdefault("refused" if finding.refusal else finding.outcome or "crash", []).append(
            finding
        )
    rows = [
        {
            "ends": outcome,
            "scenes": len(group),
            "failures": sum(bool(finding.failure) for finding in group),
            "ill_conditioned": sum(finding.conditioning > ALLOWED for finding in group),
            "largest_disagreement": max(
                (f.disagreement for f in group if f.conditioning <= ALLOWED), default=math.nan
            ),
            "largest_energy_error": max(finding.energy_error for finding in group),
            "most_evaluations": max(finding.evaluations for finding in group),
        }
        for outcome, group in sorted(groups.items())
    ]
    return Table(
        name="random-scenes",
        title="The reference on random scenes",
        frame=pd.DataFrame(rows, columns=list(_SURVEY)),
        columns=_SURVEY,
    )
