"""Runs cases and holds each against the truth. Studies say which; this is the one place that does.

A case is evaluated where it runs, so that what travels back is small: the recorded motion, the
truth at the same instants, and the numbers.
"""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, as_completed
from dataclasses import dataclass

import numpy as np

from harness.bounce import Bounce
from harness.case import Case
from harness.engines.base import resolve
from harness.engines.reference import Truth, refusal, sampled, truth
from harness.engines.registry import check_effects, engine
from harness.engines.soundness import fault
from harness.errors import HarnessError, TrajectoryError
from harness.executors import Serial
from harness.metrics.conservation import energy_drift
from harness.metrics.contact import ContactQuality, contact_quality
from harness.metrics.error import Errors, errors
from harness.metrics.features import bounces
from harness.metrics.motion import Motion, motion
from harness.simulation import Outcome, Simulation
from harness.trajectory import take
from models.scene import Scene


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Evaluation:
    """A simulation with what was measured of it.

    Parameters
    ----------
    simulation : Simulation
    motion : Motion or None
        None if there is no trajectory.
    bounces : tuple of Bounce
    energy_drift : float or None
        Over m g R.
    contact : ContactQuality or None
    truth : Motion or None
        The exact motion at the instants of `motion` up to where it is defined.
    true_bounces : tuple of Bounce
    errors : Errors or None
        None for a scene that the reference cannot carry.
    truth_pulls : bool
        True if the exact motion asks the plane to pull: no engine whose contact only pushes can
        follow it, and the errors say how the can leaves it.
    """

    simulation: Simulation
    motion: Motion | None = None
    bounces: tuple[Bounce, ...] = ()
    energy_drift: float | None = None
    contact: ContactQuality | None = None
    truth: Motion | None = None
    true_bounces: tuple[Bounce, ...] = ()
    errors: Errors | None = None
    truth_pulls: bool = False


def check(case: Case) -> None:
    """Refuse a case that would be wrong use, before anything runs.

    Raises
    ------
    HarnessError
        An unknown engine, a missing package, an effect that the engine cannot represent, a timestep
        that the engine does not take, a setting that it does not have or a value of another kind.
    """
    check_effects(case.engine, case.scene)
    chosen = engine(case.engine)
    resolve(case, chosen.settings, chosen.timestep(case) or 0.0)


def evaluate(case: Case) -> Evaluation:
    """Run a case and measure it.

    Raises
    ------
    HarnessError
        For wrong use. A numerical failure is the simulation's outcome, and so is an adapter that
        raises anything else or returns what is no simulation.
    """
    check(case)
    return measure(_simulated(case))


def _simulated(case: Case) -> Simulation:
    """Return an engine's answer to a case, or in what its adapter broke its contract."""
    chosen, version = engine(case.engine), "unknown"
    try:
        version = chosen.version
        answer = chosen.simulate(case)
        reason = fault(answer, case)
    except TrajectoryError as error:
        reason = str(error)
    except HarnessError:
        raise
    except Exception as error:  # noqa: BLE001 - whatever it is, the other cases go on
        reason = f"`simulate` raised {type(error).__name__}: {error}"
    return _broken(case, reason, version) if reason else answer


def _broken(case: Case, reason: str, version: str) -> Simulation:
    """Return that a case came to nothing, and why."""
    return Simulation(
        case=case,
        outcome=Outcome.BROKEN,
        note=reason,
        trajectory=None,
        engine_version=version,
        model=case.engine,
        timestep=engine(case.engine).timestep(case),
    )


def measure(simulation: Simulation) -> Evaluation:
    """Measure a simulation, against the truth where the reference can carry its scene."""
    scene, trajectory = simulation.case.scene, simulation.trajectory
    if trajectory is None:
        return Evaluation(simulation=simulation)
    found = motion(trajectory, scene)
    found_bounces = bounces(found, scene.can)
    drift = energy_drift(trajectory, scene) if scene.gravity > 0.0 else None
    quality = contact_quality(found)
    if scene.effects.declared() or refusal(scene):
        return Evaluation(
            simulation=simulation,
            motion=found,
            bounces=found_bounces,
            energy_drift=drift,
            contact=quality,
        )
    own = truth(scene)
    exact = _until(scene, own, float(found.time[-1]))
    common = found.time <= exact.ends
    compared = motion(take(trajectory, common), scene)
    true = motion(exact.at(compared.time), scene)
    dense = sampled(exact)
    before = dense.time < compared.time[-1]
    # to the very end of what is compared: cut at a sample, the curve would be too short
    locus = np.vstack((dense.contact_point[before, :2], true.trajectory.contact_point[-1:, :2]))
    pull = dense.contact_force[dense.time <= own.ends, 2] <= 0.0
    return Evaluation(
        simulation=simulation,
        motion=found,
        bounces=found_bounces,
        energy_drift=drift,
        contact=quality,
        truth=true,
        true_bounces=own.bounces,
        errors=errors(compared, true, found_bounces, own.bounces, locus),
        truth_pulls=bool(pull.any()),
    )


def _until(scene: Scene, own: Truth, end: float) -> Truth:
    """Return the truth up to a time in s that an engine may have needed beyond the horizon.

    The times asked for go up in steps, so that the cases of a scene share a solution.
    """
    seconds = own.ends
    while 0.0 < seconds < end:
        seconds *= 1.25
    return own if seconds == own.ends else truth(scene, seconds)


def run(
    cases: Sequence[Case],
    executor: Executor | None = None,
    on_done: Callable[[Evaluation], None] | None = None,
) -> tuple[Evaluation, ...]:
    """Evaluate cases, each once, and return them in the order given.

    Parameters
    ----------
    cases : sequence of Case
    executor : Executor, optional
        Where they run; here and one by one if left out.
    on_done : callable, optional
        Is told of each evaluation as it is ready.

    Raises
    ------
    HarnessError
        Before anything runs, if a case is wrong use.
    """
    for case in cases:
        check(case)
    executor = Serial() if executor is None else executor
    if isinstance(executor, Serial):
        return tuple(_told(evaluate(case), on_done) for case in cases)
    pending = {_submitted(executor, case): index for index, case in enumerate(cases)}
    done: dict[int, Evaluation] = {}
    for future in as_completed(pending):
        index = pending[future]
        done[index] = _told(_result(future, cases[index]), on_done)
    return tuple(_in_order(done))


def _submitted(executor: Executor, case: Case) -> Future[Evaluation]:
    """Return the future of a case, which may have failed already where an executor is broken."""
    try:
        return executor.submit(evaluate, case)
    except BrokenExecutor as error:
        failed: Future[Evaluation] = Future()
        failed.set_exception(error)
        return failed


def _result(future: Future[Evaluation], case: Case) -> Evaluation:
    """Return what came of a case, even if an engine took its whole process with it."""
    try:
        return future.result()
    except BrokenExecutor as error:
        reason = f"its process died, or one beside it, before it was done: {error}"
        return Evaluation(simulation=_broken(case, reason, "unknown"))


def _told(evaluation: Evaluation, on_done: Callable[[Evaluation], None] | None) -> Evaluation:
    """Pass an evaluation on, telling whoever listens."""
    if on_done is not None:
        on_done(evaluation)
    return evaluation


def _in_order(done: dict[int, Evaluation]) -> Iterator[Evaluation]:
    """Return the evaluations by the place of their case."""
    return (done[index] for index in sorted(done))
