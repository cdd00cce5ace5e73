"""Accepted results: where they are written, and which of their cases a run must have.

So is judged whether a run may be held against accepted results at all.
"""

from collections.abc import Sequence
from pathlib import Path

from harness.core.case import Case
from harness.engines.registry import description_of
from harness.gate.errors import ChangedScenesError, OtherEnginesError, OtherSuiteError
from harness.results.errors import FILE
from harness.results.files import write_result
from harness.results.result import Result
from harness.results.scores import CaseIdentity, identity, scene_digest
from harness.studies.comparison.suite import SUITES, suite_cases
from models.catalogue import load

PLACE = "name a folder that you may write to with --baseline"
"""What to do where accepted results cannot be written."""


def write_baseline(result: Result, folder: Path) -> Path:
    """Write accepted results into a folder, whole or not at all, and return the file.

    Raises
    ------
    WriteError
        If it cannot be written.
    """
    return write_result(result, folder / FILE, PLACE)


def cases_of_absent(
    accepted: Result, suite: str, engines: Sequence[str]
) -> tuple[CaseIdentity, ...]:
    """Return the accepted cases that a suite has of engines which are not installed."""
    scenes, known = {name: load(name) for name in SUITES[suite]}, accepted.scores
    names = map(identity, suite_cases(suite, engines, scenes))
    return tuple(name for name in names if name in known)


_FRESH = 0.25
"""Share of new cases beside accepted ones up to which a suite has grown, and is not another."""


def required_cases(
    accepted: Result, suite: str, designed: Sequence[Case], *, every_engine: bool
) -> tuple[CaseIdentity, ...]:
    """Return the accepted cases that a run must have.

    A smaller suite owes those that it has in common with the accepted one; the same suite owes
    every accepted case, of the engines that were chosen.

    Parameters
    ----------
    accepted : Result
    suite : str
        That is to be run.
    designed : sequence of Case
        Its cases.
    every_engine : bool
        False if only some engines were chosen; True for those that take part by default, too.

    Raises
    ------
    OtherEnginesError, OtherSuiteError
        If the accepted results are of other engines or another suite.
    ChangedScenesError
        If a scene has changed since.
    """
    names = {identity(case): case for case in designed}
    engines = {case.engine for case in designed}
    owed = accepted.scores
    known = {name.engine for name in owed}
    if not engines & known:
        raise OtherEnginesError(
            place=accepted.place, engines=tuple(sorted(engines)), accepted=tuple(sorted(known))
        )
    common = [name for name in names if name in owed]
    fresh = [n for n in names if n.engine in known and n not in owed]
    if accepted.suite != suite and len(fresh) > _FRESH * len(common):
        raise OtherSuiteError(
            place=accepted.place,
            suite=suite,
            accepted=accepted.suite,
            cases=len(common) + len(fresh),
            common=len(common),
        )
    changed = sorted(
        {n.scene for n in common if accepted.inputs[n.scene] != scene_digest(names[n].scene)}
    )
    if changed:
        raise ChangedScenesError(place=accepted.place, scenes=tuple(changed))
    if accepted.suite != suite:
        return tuple(common)
    return tuple(
        name
        for name in owed
        if name.engine in engines or (every_engine and description_of(name.engine).by_default)
    )
