"""The error that a case delivers: of the first turn, or of phi where the can does not bounce.

A turn is held against the closed formula where a scene has one. An integrator is asked for its own
numbers and not for samples of its motion.
"""

import math
from collections.abc import Mapping
from operator import attrgetter
from typing import Any

import numpy as np

from harness.core.case import Case
from harness.core.simulation import Outcome, Simulation
from harness.engines.reference.truth import Truth, exact_motion, solve_case, truth
from harness.engines.registry import engine_version
from harness.engines.stepping.horizon import natural_time
from harness.evaluation.effort import engine_group, expected_seconds
from harness.evaluation.evaluate import check_case, evaluate_case
from harness.evaluation.evaluation import Evaluation, Record
from harness.execution.worker import Loss, LostTaskError
from harness.metrics.quantities import turn_error
from harness.studies.study import Work, record_cache
from models.scene import Scene

TURN, PHI = "angle of turn", "largest error of phi"
"""What is compared, both in rad."""

PULLS = "the exact motion asks the plane to pull"
"""Reason for which an engine with contacts is not judged."""

ROUND_OFF = 1e-12
"""Up to which an exact motion is known where the reference has no bound of its own, rad."""

UNCOUNTED = "it has no bounce whose turn can be counted"
"""Reason for which a run to its horizon has no error."""

_SAMPLES = 2000
"""Instants at which phi is compared."""

_COMPLETE = 1.0 - 1e-9
"""Share of the exact motion's time from which on a motion has not ended early."""


def round_off(scene: Scene) -> float:
    """Return what round-off allows of the exact motion, rad."""
    agreement = exact_motion(scene).solution.agreement
    return ROUND_OFF if agreement is None else max(agreement.allowed, ROUND_OFF)


def compared_by(scene: Scene) -> str:
    """Return which error a scene is judged by."""
    return TURN if exact_motion(scene).bounces else PHI


def delivered(case: Case) -> Record:
    """Run a case and return its record.

    Returns
    -------
    dict
        `version`, `ending`, `steps`, `error` in rad, None where the motion has no such number, and
        `reason`, the sentence why.

    Raises
    ------
    HarnessError
        For wrong use, as `evaluate_case` does.
    """
    return _of_solver(case) if case.engine == "reference" else _of_engine(evaluate_case(case))


def _of_solver(case: Case) -> Record:
    own, exact = solve_case(case), exact_motion(case.scene)
    error, reason = None, ""
    if own.solution.outcome is not exact.solution.outcome:
        reason = own.solution.outcome.value
    elif exact.bounces and own.bounces:
        error = own.bounces[0].angle_of_turn - exact.bounces[0].angle_of_turn
    elif exact.bounces:
        reason = "no bounce was found"
    else:
        error = _error_of_phi(own)
    return _record(case, own.solution.outcome.value, own.solution.steps, error, reason)


def _error_of_phi(own: Truth) -> float:
    """Return the largest difference of phi from the exact motion, rad."""
    exact, T = truth(own.scene), natural_time(own.scene)
    times = np.linspace(0.0, min(own.ends, exact.ends), _SAMPLES) / T
    return float(np.abs(own.solution.at(times).phi - exact.solution.at(times).phi).max())


def _of_engine(evaluation: Evaluation) -> Record:
    run = evaluation.simulation
    error, reason = None, ""
    if evaluation.truth_pulls:
        reason = PULLS
    elif run.trajectory is None:
        reason = run.ending
    elif exact_motion(run.case.scene).bounces:
        degrees = turn_error(evaluation)
        error = None if degrees is None else math.radians(degrees)
        if error is None:
            reason = run.ending if run.outcome is not Outcome.FINISHED else UNCOUNTED
    elif not _complete(run):
        reason = run.ending
    elif evaluation.errors is not None:
        error = evaluation.errors.phi_max
    return _record(run.case, run.ending, run.steps, error, reason)


def _complete(run: Simulation) -> bool:
    """Whether a run went on for as long as the exact motion.

    One that reached its horizon did, whose last sample is up to a step before it.
    """
    if run.outcome is Outcome.FINISHED or run.trajectory is None:
        return run.trajectory is not None
    return bool(run.trajectory.time[-1] >= _COMPLETE * truth(run.case.scene).ends)


def _record(case: Case, ending: str, steps: int, error: float | None, reason: str) -> Record:
    number = None if error is None or not math.isfinite(error) else abs(error)
    return {
        "version": engine_version(case.engine),
        "ending": ending,
        "steps": steps,
        "error": number,
        "reason": reason or ("" if number is not None else "no number can be told"),
    }


def _lost(case: Case, error: LostTaskError) -> Record:
    return _record(case, Outcome[error.loss.name].value, 0, None, error.reason)


_ENDINGS_LOST = frozenset(Outcome[loss.name].value for loss in Loss)


def was_lost(record: Record) -> bool:
    """Whether the process of a run died or had to be stopped."""
    return record["ending"] in _ENDINGS_LOST


def _manifest(case: Case, record: Record) -> Mapping[str, Any]:
    return {
        "digest": case.digest(record["version"]),
        "label": case.label(),
        "command": case.command(),
        "engine": case.engine,
        "engine_version": record["version"],
        "outcome": record["ending"],
    }


DELIVERING: Work[Case, Record] = Work(
    name="delivered errors",
    call=delivered,
    lost=_lost,
    label=Case.label,
    cache=record_cache("delivered", delivered.__module__),
    check=check_case,
    effort=expected_seconds,
    group=engine_group,
    about=attrgetter("scene"),
    manifest=_manifest,
)
"""Run a case and return the error that it delivers."""
