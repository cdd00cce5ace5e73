"""The verdict on a run: the worst symptom of failure seen in it, else how accurate it is."""

import math
from dataclasses import replace

import numpy as np

from harness.core.bounce import PROMINENCE
from harness.core.simulation import Outcome
from harness.evaluation.evaluation import Evaluation
from harness.metrics.error import rotation_between
from harness.metrics.motion import shares
from harness.studies.stability.failure_criteria import (
    ClassifiedRun,
    Exact,
    StabilityStatus,
    Symptom,
    dissipated,
    diverged,
    exact,
    free_rotation,
    gained,
    stuck_flat,
    tunnelled,
    unresolved,
)

ACCURATE_PHI = 0.01
"""Of the largest true phi, root mean square over the run."""

ACCURATE_TURN = math.radians(2.0)
"""rad, of each turn, and of the orientation of a can that flies free: 1 % of a hard bounce's."""

_UNFIT = {
    Outcome.MISMATCH,
    Outcome.BROKEN,
    Outcome.NO_SOLUTION,
    Outcome.CRASHED,
    Outcome.HUNG,
    Outcome.OUT_OF_MEMORY,
    Outcome.STOPPED,
}


def classify(e: Evaluation) -> ClassifiedRun:
    """Return the verdict on a run."""
    verdict, symptom = _verdict(e)
    return ClassifiedRun(
        simulation=replace(e.simulation, trajectory=None), verdict=verdict, symptom=symptom
    )


def _verdict(e: Evaluation) -> tuple[StabilityStatus, Symptom]:
    scene, outcome = e.simulation.case.scene, e.simulation.outcome
    if outcome in _UNFIT:
        words = e.simulation.note or outcome.value
        return StabilityStatus.REFUSED, Symptom(time=0.0, number=math.nan, words=words)
    truth = exact(e)
    # an impact or a rim that slides may lose energy: it is kept where the exact motion is known
    keeps = math.inf if scene.gravity == 0.0 else 0.0 if truth is None else float(truth.time[-1])
    for verdict, symptom in (
        (StabilityStatus.DIVERGES, diverged(e)),
        (StabilityStatus.TUNNELS, tunnelled(e)),
        (StabilityStatus.GAINS, gained(e)),
        (StabilityStatus.FLAT, stuck_flat(e, truth)),
        *sorted(
            (
                (
                    StabilityStatus.UNRESOLVED,
                    None if truth is None else unresolved(e, truth.bounces),
                ),
                (StabilityStatus.DISSIPATES, dissipated(e, keeps)),
            ),
            # energy that is lost in a bounce which the steps pass over is lost to the steps
            key=lambda pair: math.inf if pair[1] is None else pair[1].time,
        ),
    ):
        if symptom is not None:
            return verdict, symptom
    if e.motion is None or outcome is Outcome.TOO_SLOW:
        return StabilityStatus.UNRESOLVED, Symptom(time=0.0, number=math.nan, words=outcome.value)
    return _accuracy(e, truth)


def _accuracy(e: Evaluation, truth: Exact | None) -> tuple[StabilityStatus, Symptom]:
    """Return how near a sound run is to the exact motion."""
    if e.simulation.case.scene.gravity == 0.0:
        symptoms = [_free(e)]
    elif truth is not None:
        symptoms = [_phi(e, truth), *_turns(e, truth)]
    else:
        end = 0.0 if e.motion is None else float(e.motion.time[-1])
        words = "no exact motion; the run reached this time, s"
        return StabilityStatus.STABLE, Symptom(time=end, number=end, words=words)
    worst, allowed = max(symptoms, key=lambda pair: pair[0].number / pair[1])
    good = worst.number <= allowed  # false for what is no number
    return StabilityStatus.ACCURATE if good else StabilityStatus.INACCURATE, worst


def _phi(e: Evaluation, truth: Exact) -> tuple[Symptom, float]:
    """Return the error of phi over its largest value, rms."""
    found = np.empty(0) if e.motion is None else e.motion.angles.phi[: len(truth.time)]
    off = found - truth.phi
    share = math.sqrt(float(np.sum(shares(truth.time) * off**2))) / float(truth.phi.max())
    worst = float(truth.time[np.argmax(np.abs(off))])
    words = "error of phi over its largest, rms"
    return Symptom(time=worst, number=share, words=words), ACCURATE_PHI


def _turns(e: Evaluation, truth: Exact) -> list[tuple[Symptom, float]]:
    """Return the worst error of a turn; infinite if a bounce is missing."""
    # a ripple is no bounce; and one is complete in a record once phi has passed its next maximum
    low = (1.0 - 2.0 * PROMINENCE) * float(truth.phi.max())
    known = [bounce for bounce in truth.bounces if bounce.phi_min < low]
    due = [bounce for bounce in known if bounce.end < _SEEN * float(truth.time[-1])]
    if len(e.bounces) < len(due):
        missing = due[len(e.bounces)].time
        number, words = float(len(due) - len(e.bounces)), "bounces missing"
        return [(Symptom(time=missing, number=number, words=words), 0.5)]
    pairs = [
        (abs(found.angle_of_turn - true.angle_of_turn), true.time)
        for found, true in zip(e.bounces, known, strict=False)
    ]
    if not pairs:
        return []
    error, time = max(pairs)
    return [(Symptom(time=time, number=error, words="error of a turn, rad"), ACCURATE_TURN)]


_SEEN = 0.98


def _free(e: Evaluation) -> tuple[Symptom, float]:
    """Return the largest error of the orientation of a can that flies free."""
    trajectory = e.simulation.trajectory
    if trajectory is None:
        return Symptom(time=0.0, number=math.inf, words="no motion"), ACCURATE_TURN
    true = free_rotation(trajectory, e.simulation.case.scene)
    off = rotation_between(trajectory.quaternion, true)
    worst = int(np.argmax(off))
    words = "error of the orientation, rad"
    return Symptom(time=float(trajectory.time[worst]), number=float(off[worst]), words=words), (
        ACCURATE_TURN
    )
