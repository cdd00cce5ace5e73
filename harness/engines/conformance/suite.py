"""The contract in full: every clause, in order, and its result for an engine."""

from dataclasses import replace

from harness.engines.base import Engine
from harness.engines.conformance import answers, effects, fixture, repeats
from harness.engines.conformance.fixture import (
    BrokenContractError,
    Check,
    ClauseResult,
    ClauseStatus,
    Fixture,
    holds,
    not_applicable,
)

_RUNS = "trajectory"

_MODULES = [module.__name__ for module in (answers, repeats, effects)]
"""Modules whose clauses are the contract: importing a module enters its clauses."""

CHECKS = tuple(sorted(fixture.CHECKS, key=lambda c: _MODULES.index(c.look.__module__)))
"""Every clause, in the order in which they are worth reading."""


def conform(engine: Engine) -> tuple[ClauseResult, ...]:
    """Return the result of each clause for an engine.

    Parameters
    ----------
    engine : Engine
        Need not be registered; what needs a name in other processes is then not applicable.
    """
    bench = Fixture(engine)
    results: list[ClauseResult] = []
    runs = True
    for check in CHECKS:
        if check.needs_run and not runs:
            result = not_applicable(f"needs a run that passes the check '{_RUNS}'")
        else:
            result = _look(check, bench)
        if check.name == _RUNS:
            runs = result.result is ClauseStatus.PASSED
        results.append(replace(result, name=check.name, sentence=check.sentence))
    return tuple(results)


def _look(check: Check, bench: Fixture) -> ClauseResult:
    """Return the result of a check; whatever the adapter raises is a failure of it."""
    try:
        return check.look(bench)
    except BrokenContractError as error:
        return ClauseResult(result=ClauseStatus.FAILED, detail=str(error))
    except Exception as error:  # noqa: BLE001 - the suite reports on any adapter to its end
        return holds(f"raised {type(error).__name__}: {error}", "")
