"""The gate of `validate`: accepted results are read before anything runs, and judged at the end."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

from rich.console import Console
from rich.markup import escape

from harness.artefact import Artefact, Prose, Table
from harness.case import Case
from harness.cli import printing
from harness.errors import InvalidSettingError
from harness.gate import (
    FILE,
    GATE,
    BaselineError,
    Difference,
    Scores,
    check_place,
    count,
    differences,
    measured,
    owed,
    read,
    read_scores,
    regressions,
    scored,
    write_baseline,
)
from harness.gate.identity import Identity
from harness.provenance import provenance
from harness.runner import Evaluation

BASELINE = Path("reports/baseline")
"""Where results are accepted if nothing else is said."""

_ROWS = 40
"""Of the table in the terminal; the report has all."""

COLUMNS = ("accepted", "found", "tolerance", "factor", "verdict", "note")
"""Of the table in the terminal."""

_WORDS = ("scene", "engine", "profile", "timestep_s", "quantity")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Gate:
    """What a run is to be held against.

    Parameters
    ----------
    suite : str
    designed : tuple of Case
        Of the suite, without settings on top.
    settings : mapping of str to str
        What is set on top, by `engine.name`.
    accepted : Scores or None
        None if nothing was accepted before.
    owed : tuple of Identity
        Accepted cases that the run must have.
    place : Path or None
        Folder to accept the run into.
    """

    suite: str
    designed: tuple[Case, ...]
    settings: Mapping[str, str]
    accepted: Scores | None
    owed: tuple[Identity, ...]
    place: Path | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Held:
    """A run held against what was accepted."""

    scores: Scores
    differences: tuple[Difference, ...]
    artefacts: tuple[Artefact, ...]

    @property
    def failed(self) -> bool:
        """Whether something got worse or is gone."""
        return bool(regressions(self.differences))


def opened(
    suite: str,
    designed: Sequence[Case],
    settings: Mapping[str, str],
    baseline: Path | None,
    *,
    accept: bool,
    every_engine: bool,
) -> Gate:
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
    debts: tuple[Identity, ...] = ()
    if accept and folder is not None:
        check_place(folder)
    if folder is not None and (not accept or (folder / FILE).is_file()):
        try:
            accepted = read_scores(folder)
            debts = owed(accepted, suite, designed, every_engine=every_engine)
        except BaselineError:
            if not accept:
                raise
            accepted = None  # what does not fit is what is to be replaced
    return Gate(
        suite=suite,
        designed=tuple(designed),
        settings=settings,
        accepted=accepted,
        owed=debts,
        place=folder if accept else None,
    )


def held(gate: Gate, evaluations: Sequence[Evaluation]) -> Held:
    """Return a run held against what was accepted; against nothing if that is what there is."""
    scores = Scores(
        suite=gate.suite,
        scores=MappingProxyType({one.identity: one for one in scored(gate.designed, evaluations)}),
        versions=MappingProxyType(_versions(evaluations)),
        made=MappingProxyType(provenance().to_dict()),
        settings=gate.settings,
    )
    if gate.accepted is None:
        return Held(scores=scores, differences=(), artefacts=())
    found = differences(gate.accepted, scores, expected=gate.owed)
    return Held(
        scores=scores,
        differences=found,
        artefacts=read(found, gate.accepted, scores, GATE),
    )


def _versions(evaluations: Sequence[Evaluation]) -> dict[str, str]:
    """Return the versions of what made a run."""
    versions = {"rockingcan": provenance().rockingcan}
    for e in evaluations:
        versions[e.simulation.case.engine] = e.simulation.engine_version
    return versions


def accepted(gate: Gate, run: Held, executor: Executor) -> Path:
    """Measure how far each result is free to move, accept the run, and return the file."""
    place = gate.place or BASELINE
    scores = list(run.scores.scores.values())
    with printing.progress() as bar:
        task = bar.add_task("measuring the spread", total=count(gate.designed, scores))
        found = measured(
            gate.designed,
            scores,
            executor,
            lambda label: bar.update(task, advance=1, description=label),
        )
    by_identity = MappingProxyType({one.identity: one for one in found})
    return write_baseline(replace(run.scores, scores=by_identity), place)


def show_changes(artefacts: Sequence[Artefact], console: Console, columns: Sequence[str]) -> None:
    """Print what a comparison found: what has changed, then the sentences."""
    for artefact in artefacts:
        if isinstance(artefact, Table):
            moved = artefact.frame[~artefact.frame["verdict"].isin(_QUIET)]
            if len(moved):
                top = replace(artefact, title="What has changed", frame=moved.head(_ROWS))
                console.print(printing.data(top, (*_WORDS, *columns)))
            if len(moved) > _ROWS:
                console.print(f"... and {len(moved) - _ROWS} more")
    for artefact in artefacts:
        if isinstance(artefact, Prose):
            console.print(escape(artefact.text))


_QUIET = ("same", "not judged", "undecidable")
"""Verdicts that the terminal leaves out."""
