"""What the full suite asks beyond the comparison: who is to blame, and which error it is."""

from collections.abc import Iterable, Sequence

from harness import face
from harness.artefact import Artefact, Prose
from harness.case import Case
from harness.cli.attribution import evaluations, told
from harness.cli.running import Running
from harness.provenance import provenance
from harness.report import Chapter
from harness.runner import Evaluation
from harness.studies import attribution, errors
from models.catalogue import load

_ATTRIBUTED = ("gentle-rock", "paper-release")
_SPLIT = ("gentle-rock",)
"""Scenes that both studies can carry: under gravity, ideal, with a bounce."""


def further(engines: Sequence[str] | None, running: Running) -> list[Chapter]:
    """Return the attribution and the three errors of every engine, as chapters of a report."""
    names = face.stepping_engines(engines)
    ways = [attribution.path(load(scene), name) for scene in _ATTRIBUTED for name in names]
    plans = [errors.plan(load(scene), name) for scene in _SPLIT for name in names]
    designs = [attribution.design(way) for way in ways]
    ladders = [errors.design(plan) for plan in plans]
    cases = tuple(dict.fromkeys(case for design in (*designs, *ladders) for case in design))
    found = dict(zip(cases, evaluations(cases, running), strict=True))
    return [
        _chapter(
            "Attribution",
            [
                attribution.read(attribution.attribution(way, [found[c] for c in design]))
                for way, design in zip(ways, designs, strict=True)
            ],
            [found[case] for case in _each(designs)],
        ),
        _chapter(
            "Three errors",
            [
                errors.read(errors.three_errors(plan, [found[c] for c in ladder]))
                for plan, ladder in zip(plans, ladders, strict=True)
            ],
            [found[case] for case in _each(ladders)],
        ),
    ]


def _each(designs: Iterable[Iterable[Case]]) -> list[Case]:
    return list(dict.fromkeys(case for design in designs for case in design))


def _chapter(
    title: str, parts: Sequence[Sequence[Artefact]], found: Sequence[Evaluation]
) -> Chapter:
    """Return a chapter with the words of all its parts first."""
    artefacts = [artefact for part in parts for artefact in part]
    return Chapter(
        title=title,
        artefacts=tuple(sorted(artefacts, key=lambda a: not isinstance(a, Prose))),
        cases=tuple(told(evaluation) for evaluation in found),
        provenance=provenance(),
    )
