"""The main job: run the suite, hold it against accepted results, write the report.

What the full suite asks beyond the comparison: who is to blame, and which error it is.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from harness import api
from harness.cli import options, run_options, terminal
from harness.cli.reports import joined_sections, show_changes
from harness.cli.results import result_of, with_spread
from harness.cli.settings import engine_settings, settings_to_dict
from harness.cli.study_command import not_installed, run_with_progress, shown
from harness.core.environments import EVERY_ENGINE
from harness.core.errors import InvalidSettingError
from harness.core.provenance import provenance
from harness.core.report_model import Prose
from harness.core.simulation import Outcome
from harness.gate.baseline import PLACE, cases_of_absent, required_cases, write_baseline
from harness.gate.comparison import Difference, differences
from harness.gate.report import GATE, gate_report, regressions
from harness.progress import report_progress
from harness.report.atomic_folder import check_writable
from harness.report.layout import Section
from harness.report.write import write_chapters
from harness.results.errors import FILE, BaselineError
from harness.results.files import check_place, manifest_keys, read_scores
from harness.results.result import Result
from harness.results.scores import CaseIdentity
from harness.studies.attribution.study import AttributionStudy
from harness.studies.comparison.headings import HeadingStudy
from harness.studies.comparison.rim import RimStudy
from harness.studies.comparison.study import ComparisonStudy, plan_comparison
from harness.studies.errors.plan import plan_errors
from harness.studies.errors.study import ErrorsStudy
from harness.studies.shared.ablation import ablation_path
from harness.studies.study import Results, Study, StudyGroup
from models.catalogue import load

_BASELINE = Path("reports/baseline")
"""Where results are accepted if nothing else is said."""

_ATTRIBUTED = ("gentle-rock", "paper-release")
_SPLIT = ("gentle-rock",)
"""Scenes that both studies can carry: under gravity, ideal, with a bounce."""

_WHOLE = "full"
"""The suite that goes on to ask who is to blame."""


@run_options.with_run_options
def validate(  # noqa: PLR0917 - a parameter an option
    suite: Annotated[
        str,
        typer.Option(
            help="quick: a minute or so; full: long ladders, causes, three errors; "
            "field: what users complain of; contact: impacts, and a contact that gives way.",
        ),
    ] = "quick",
    engine: options.EngineNames = None,
    out: options.ReplacedFolder = Path("reports/latest"),
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="ENGINE.KEY=VALUE",
            help="A setting on top of every case of an engine, to see what it does; repeat it.",
        ),
    ] = None,
    baseline: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Hold the results against accepted ones; leave with code 1 if one got worse.",
        ),
    ] = None,
    accept: Annotated[  # noqa: FBT002 - a switch of the command line
        bool,
        typer.Option(
            "--accept",
            help=f"Measure how far each result may move and accept it, into {_BASELINE} or "
            "--baseline, in place of what was accepted there.",
        ),
    ] = False,
    with_: Annotated[
        list[Path] | None,
        typer.Option(
            "--with",
            metavar="DIR",
            help="A report of another study to join, such as reports/stability; repeat it.",
        ),
    ] = None,
    figures: options.Figures = False,  # noqa: FBT002 - a switch of the command line
    *,
    running: run_options.RunOptions,
) -> None:
    """A report on every engine and scene: the main job.

    Every scene of the suite is run in every engine, and held against the exact motion.
    """
    engines = api.stepping_engines(engine)
    absent = api.absent_engines(engine)
    chosen = engine_settings(set_ or [], engines)
    study = plan_comparison(suite, engines, chosen)
    check_writable(out)
    others = joined_sections(with_ or [])
    settings = settings_to_dict(chosen)
    if accept and settings:
        allowed = "nothing beside --set: accepted results are an engine's own"
        raise InvalidSettingError("--accept", accept, allowed)
    place = (baseline or _BASELINE) if accept else None
    all_engines = not engine or EVERY_ENGINE in engine
    gate = _open_gate(study, place or baseline, absent, accept=accept, every_engine=all_engines)
    if running.store is not None and (gate is not None or accept):
        # an engine that was built anew often has the version of its last release, and so its
        # results the key of those that are kept: a gate looks into no store
        running = replace(running, store=replace(running.store, fresh=True))
    causes = _causes(engines) if suite == _WHOLE else ()
    # in one run, so that what two of them ask is done once and the estimate is of all
    turned = HeadingStudy(engines=engines, settings=chosen)
    under = RimStudy(engines=engines, settings=chosen)
    further: tuple[Study, ...] = (turned, under, *causes)
    every = run_with_progress(StudyGroup(name=study.name, studies=(study, *further)), running)
    done = every.only(study.next_jobs(every))
    evaluations, artefacts = study.evaluations(done), (*study.report(done), *not_installed(absent))
    scores = result_of(study, evaluations, settings)
    compared = gate.compare(scores) if gate else ()
    changes = gate_report(compared, gate.accepted, scores, GATE) if gate else ()
    comparison = Section(
        title=f"rockingcan, {study.name}",
        artefacts=(*changes, *artefacts),
        cases=tuple(
            {**record, **manifest_keys(case, suite, settings)}
            for record, case in zip(done.manifest(), study.designed, strict=True)
        ),
        provenance=provenance(),
    )
    others = [_section(each, every) for each in further] + others
    with report_progress() as progress:
        page = write_chapters(
            [comparison, *others],
            out,
            title=comparison.title,
            provenance=comparison.provenance,
            figures=figures,
            jobs=running.jobs,
            on_progress=progress,
        )
    shown({"scorecard": (), "summary": ()})(done, artefacts)
    show_changes(changes)
    console = terminal.stdout_console()
    if place is not None:
        accepted = write_baseline(with_spread(study, scores, running), place)
        console.print(escape(f"\nAccepted: {accepted}"))
    console.print(escape(f"\nThe report: {page}"))
    wrong = [e for e in evaluations if e.simulation.outcome is Outcome.MISMATCH]
    for evaluation in wrong:
        console.print(terminal.parity(evaluation.simulation.parity))
    if wrong or (regressions(compared) and not accept):
        raise typer.Exit(1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Gate:
    """Accepted results, those of their cases that a run must have, and engines that are absent."""

    accepted: Result
    owed: tuple[CaseIdentity, ...]
    absent: tuple[str, ...]

    def compare(self, scores: Result) -> tuple[Difference, ...]:
        """Return the differences of a run from the accepted results."""
        return differences(self.accepted, scores, expected=self.owed, not_installed=self.absent)


def _open_gate(
    study: ComparisonStudy,
    folder: Path | None,
    absent: tuple[str, ...],
    *,
    accept: bool,
    every_engine: bool,
) -> _Gate | None:
    """Return the accepted results for a run, or refuse before anything runs; None without any.

    Parameters
    ----------
    study : ComparisonStudy
    folder : Path, optional
        Of the accepted results.
    absent : tuple of str
        Engines that would run if they were installed.
    accept : bool
    every_engine : bool
        False if only some engines were chosen.

    Raises
    ------
    HarnessError
        If accepted results cannot be read, do not fit the run, or could not be written.
    """
    if folder is None:
        return None
    if accept:
        check_place(folder, PLACE)
        if not (folder / FILE).is_file():
            return None
    try:
        accepted = read_scores(folder)
        owed = required_cases(accepted, study.suite, study.designed, every_engine=every_engine)
        owed += cases_of_absent(accepted, study.suite, absent)
    except BaselineError:
        if not accept:
            raise
        return None  # what does not fit is what is to be replaced
    return _Gate(accepted=accepted, owed=tuple(dict.fromkeys(owed)), absent=absent)


def _causes(names: Sequence[str]) -> tuple[StudyGroup, ...]:
    """Return the attribution and the three errors of every engine."""
    return (
        StudyGroup(
            name="Attribution",
            studies=tuple(
                AttributionStudy(path=ablation_path(load(scene), name))
                for scene in _ATTRIBUTED
                for name in names
            ),
        ),
        StudyGroup(
            name="Three errors",
            studies=tuple(
                ErrorsStudy(plan=plan_errors(load(scene), name))
                for scene in _SPLIT
                for name in names
            ),
        ),
    )


def _section(study: Study, done: Results) -> Section:
    """Return a study as a chapter of a report."""
    return Section(
        title=study.name,
        # the words of all parts first
        artefacts=tuple(sorted(study.report(done), key=lambda a: not isinstance(a, Prose))),
        cases=tuple(done.only(study.next_jobs(done)).manifest()),
        provenance=provenance(),
    )
