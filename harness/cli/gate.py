"""The gate of `validate`: accepted results are read before anything runs, and judged at the end.

Two reports held against each other: two versions of an engine, two machines, two settings.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from harness.cli import terminal
from harness.cli.json_output import to_json
from harness.core.errors import InvalidSettingError
from harness.core.provenance import provenance
from harness.core.report_model import Artefact, Prose, Table, rows_of
from harness.core.verdict import Status
from harness.evaluation.evaluation import Evaluation
from harness.gate.baseline import (
    FILE,
    BaselineError,
    check_place,
    read_baseline,
    read_scores,
    required_cases,
    write_baseline,
)
from harness.gate.comparison import Difference, differences
from harness.gate.report import GATE, SIDES, changed, gate_report, regressions, sentences
from harness.gate.scores import CaseIdentity, Scores, scored
from harness.gate.spread import count, measured
from harness.studies.comparison.study import ComparisonStudy

BASELINE = Path("reports/baseline")
"""Where results are accepted if nothing else is said."""

_ROWS = 40
"""Of the table in the terminal; the report has all."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GateRequest:
    """What a run is to be held against.

    Parameters
    ----------
    study : ComparisonStudy
    settings : mapping of str to str
        What is set on top, by `engine.name`.
    accepted : Scores or None
        None if nothing was accepted before.
    owed : tuple of CaseIdentity
        Accepted cases that the run must have.
    place : Path or None
        Folder to accept the run into.
    """

    study: ComparisonStudy
    settings: Mapping[str, str]
    accepted: Scores | None
    owed: tuple[CaseIdentity, ...]
    place: Path | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GateResult:
    """A run held against what was accepted."""

    scores: Scores
    differences: tuple[Difference, ...]
    artefacts: tuple[Artefact, ...]

    @property
    def failed(self) -> bool:
        """Whether something got worse or is gone."""
        return bool(regressions(self.differences))


def open_gate(
    study: ComparisonStudy,
    settings: Mapping[str, str],
    baseline: Path | None,
    *,
    accept: bool,
    every_engine: bool,
) -> GateRequest:
    """Return the gate of a run, or refuse before anything runs.

    Raises
    ------
    HarnessError
        If accepted results cannot be read, do not fit the run, or could not be written.
    """
    if accept and settings:
        allowed = "nothing beside --set: accepted results are an engine's own"
        raise InvalidSettingError("--accept", True, allowed)  # noqa: FBT003 - as it was typed
    folder = BASELINE if accept and baseline is None else baseline
    accepted: Scores | None = None
    debts: tuple[CaseIdentity, ...] = ()
    if accept and folder is not None:
        check_place(folder)
    if folder is not None and (not accept or (folder / FILE).is_file()):
        try:
            accepted = read_scores(folder)
            debts = required_cases(accepted, study.suite, study.designed, every_engine=every_engine)
        except BaselineError:
            if not accept:
                raise
            accepted = None  # what does not fit is what is to be replaced
    return GateRequest(
        study=study,
        settings=settings,
        accepted=accepted,
        owed=debts,
        place=folder if accept else None,
    )


def compare_to_baseline(gate: GateRequest, evaluations: Sequence[Evaluation]) -> GateResult:
    """Return a run held against what was accepted; against nothing if that is what there is."""
    scores = Scores(
        suite=gate.study.suite,
        scores={one.identity: one for one in scored(gate.study.designed, evaluations)},
        versions=_versions(evaluations),
        made=provenance().to_dict(),
        settings=gate.settings,
    )
    if gate.accepted is None:
        return GateResult(scores=scores, differences=(), artefacts=())
    found = differences(gate.accepted, scores, expected=gate.owed)
    return GateResult(
        scores=scores,
        differences=found,
        artefacts=gate_report(found, gate.accepted, scores, GATE),
    )


def _versions(evaluations: Sequence[Evaluation]) -> dict[str, str]:
    """Return the versions of what made a run."""
    versions = {"rockingcan": provenance().rockingcan}
    for e in evaluations:
        versions[e.simulation.case.engine] = e.simulation.engine_version
    return versions


def accept_baseline(gate: GateRequest, run: GateResult, executor: Executor) -> Path:
    """Measure how far each result is free to move, accept the run, and return the file."""
    place = gate.place or BASELINE
    scores = list(run.scores.scores.values())
    with terminal.progress_bar() as bar:
        task = bar.add_task("measuring the spread", total=count(gate.study.designed, scores))
        found = measured(
            gate.study.designed,
            scores,
            executor,
            lambda label: bar.update(task, advance=1, description=label),
        )
    by_identity = {one.identity: one for one in found}
    return write_baseline(replace(run.scores, scores=by_identity), place)


def show_changes(artefacts: Sequence[Artefact], console: Console) -> None:
    """Print what a comparison found: what has changed, then the sentences."""
    for artefact in artefacts:
        if isinstance(artefact, Table):
            moved = artefact.frame[[v.status not in _QUIET for v in artefact.frame["verdict"]]]
            if len(moved):
                top = replace(artefact, title="What has changed", frame=moved.head(_ROWS))
                console.print(
                    terminal.table_artefact(top, [name for name in top.shown if name != "case"])
                )
            if len(moved) > _ROWS:
                console.print(f"... and {len(moved) - _ROWS} more")
    for artefact in artefacts:
        if isinstance(artefact, Prose):
            console.print(escape(artefact.text))


_QUIET = (Status.SAME, Status.NOT_JUDGED, Status.UNDECIDABLE)
"""Verdicts that the terminal leaves out."""


def diff(
    a: Annotated[
        Path, typer.Argument(metavar="A", help="Folder of a report, or of accepted results.")
    ],
    b: Annotated[Path, typer.Argument(metavar="B", help="The same, to hold against it.")],
    baseline: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Accepted results whose measured spread tells what may differ: reports have none.",
        ),
    ] = None,
    gate: Annotated[  # noqa: FBT002 - a switch of the command line
        bool, typer.Option("--gate", help="Leave with code 1 if anything is better in A.")
    ] = False,
    json: Annotated[  # noqa: FBT002 - a switch of the command line
        bool, typer.Option("--json", help="Print one JSON object and nothing else.")
    ] = False,
) -> None:
    """Say what differs between two reports of validate, case by case, quantity by quantity.

    For example: rockingcan diff reports/before reports/after --baseline reports/baseline
    """
    first, second = read_scores(a), read_scores(b)
    spreads = None if baseline is None else read_baseline(baseline)
    if not set(first.scores) & set(second.scores):
        raise BaselineError(f"'{a}' and '{b}' have no case in common: there is nothing to compare")
    found = differences(first, second, spreads=spreads)
    if json:
        told = sentences(found, first, second, SIDES, spreads)
        rows = rows_of(SIDES.columns(), changed(found))
        typer.echo(to_json({"differences": rows, "sentences": told}))
    else:
        show_changes(gate_report(found, first, second, SIDES, spreads), terminal.stdout_console())
    if gate and regressions(found):
        raise typer.Exit(1)
