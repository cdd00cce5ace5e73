"""Whether a run may be held against accepted results at all, and which cases it owes."""

from collections.abc import Sequence

from harness.case import Case
from harness.gate.errors import BaselineError
from harness.gate.identity import Identity, identity, scene_digest
from harness.gate.scores import Scores

_FRESH = 0.25
"""Share of new cases beside accepted ones up to which a suite has grown, and is not another."""


def owed(
    accepted: Scores, suite: str, designed: Sequence[Case], *, every_engine: bool
) -> tuple[Identity, ...]:
    """Return the accepted cases that a run must have.

    A smaller suite owes those that it has in common with the accepted one; the same suite owes
    every accepted case, of the engines that were chosen.

    Parameters
    ----------
    accepted : Scores
    suite : str
        That is to be run.
    designed : sequence of Case
        Its cases.
    every_engine : bool
        False if only some engines were chosen.

    Raises
    ------
    BaselineError
        If the accepted results are of another suite or engine, or a scene has changed since.
    """
    names = {identity(case): case for case in designed}
    engines = {case.engine for case in designed}
    known = {name.engine for name in accepted.scores}
    if not engines & known:
        raise BaselineError(
            f"'{accepted.place}' holds no accepted results of {', '.join(sorted(engines))}, only "
            f"of {', '.join(sorted(known)) or 'none'}; accept some first, with --accept"
        )
    common = [name for name in names if name in accepted.scores]
    fresh = [n for n in names if n.engine in known and n not in accepted.scores]
    if accepted.suite != suite and len(fresh) > _FRESH * len(common):
        raise BaselineError(
            f"'{accepted.place}' holds the {accepted.suite} suite, which has {len(common)} of the "
            f"{len(common) + len(fresh)} cases of the {suite} suite; run --suite {accepted.suite}, "
            f"or accept the {suite} suite with --accept"
        )
    changed = sorted(
        {
            name.scene
            for name in common
            if accepted.scores[name].scene_digest != scene_digest(names[name].scene)
        }
    )
    if changed:
        raise BaselineError(
            f"'{accepted.place}' was accepted for other scenes: since then {', '.join(changed)} "
            "changed, and errors of two motions cannot be compared; accept anew with --accept"
        )
    if accepted.suite != suite:
        return tuple(common)
    return tuple(n for n in accepted.scores if every_engine or n.engine in engines)
