"""Runs cases and compares each with the truth: the one place that does so, for every study.

A case is measured in the process that runs it, so that little is sent back: the recorded motion,
the truth at the same instants, and the numbers.
"""

import pickle
from contextlib import suppress
from dataclasses import replace

import numpy as np

from harness.core.case import PROFILES, RECORDED, Case
from harness.core.errors import (
    BrokenEngineError,
    HarnessError,
    InvalidSettingError,
    TrajectoryError,
    UnknownSettingError,
)
from harness.core.scene_limits import check_scene_limits
from harness.core.simulation import Outcome, Simulation
from harness.core.trajectory import take
from harness.engines.base import resolve
from harness.engines.contract import contract_violation, describe_exception
from harness.engines.ladder import chooses_steps
from harness.engines.reference import PARTED
from harness.engines.reference.assumption_checks import divergence_of, findings
from harness.engines.reference.to_reference_problem import refusal
from harness.engines.reference.truth import Truth, sample_truth, truth
from harness.engines.registry import (
    check_effects,
    engine,
    engine_version,
    installed,
    is_constraint,
    is_ours,
    timestep_of,
)
from harness.evaluation.evaluation import Evaluation
from harness.execution.worker import LostTaskError
from harness.metrics.bounces import bounces
from harness.metrics.energy import energy_drift
from harness.metrics.error import errors, rotation_between
from harness.metrics.motion import contact_quality, motion
from models.scene import Scene

_NONE = 1e-9
"""Share of the weight: at lift-off the normal force is zero but for a round-off far below it."""


def check_case(case: Case) -> None:
    """Refuse a case that would be wrong use, before anything runs.

    Raises
    ------
    HarnessError
        A scene beyond the limits, an unknown engine, a missing package, an effect that the engine
        cannot represent, a timestep or a profile that it does not take, a setting that it does not
        have or a value of another kind.
    """
    check_scene_limits(case.scene)
    if case.profile not in PROFILES:
        raise InvalidSettingError("profile", case.profile, ", ".join(PROFILES))
    check_effects(case.engine, case.scene)
    chosen = engine(case.engine)
    if case.profile == "adaptive" and chooses_steps(case.engine):
        others = ", ".join(name for name in installed() if not chooses_steps(name))
        raise InvalidSettingError(
            "profile",
            case.profile,
            f"default or matched; engine '{case.engine}' chooses its own steps in both, and the "
            f"steps of {others} can be made to follow the motion",
        )
    try:
        resolve(case, chosen.settings, timestep_of(case, chosen) or 0.0)
    except UnknownSettingError as error:
        owners = _with_setting(error.name)
        raise UnknownSettingError(error.engine, error.name, error.available, owners) from None


def _with_setting(setting: str) -> tuple[str, ...]:
    """Return the engines, of those that can be made here, which have a setting of a name."""
    found = []
    for name in installed():
        with suppress(HarnessError):
            found += [name for one in engine(name).settings if one.name == setting]
    return tuple(found)


def evaluate(case: Case) -> Evaluation:
    """Run a case and measure it.

    Raises
    ------
    HarnessError
        For wrong use. A numerical failure is the simulation's outcome, and so is an adapter that
        raises anything else or returns what is no simulation.
    """
    check_case(case)
    return measure_simulation(_simulated(case))


def _simulated(case: Case) -> Simulation:
    """Return the simulation of a case that is run alone; the loss of its process is its outcome."""
    try:
        return simulate_case(case)
    except LostTaskError as error:
        return failed_simulation(case, error.reason, Outcome[error.loss.name])


def evaluate_case(case: Case) -> Evaluation:
    """Run a case among others and measure it; an exception of its adapter becomes its outcome.

    Raises
    ------
    HarnessError
        For wrong use that `check_case` finds, or that only an engine of this project finds when it
        compiles the case; it says of which case.
    LostTaskError
        If the process dies in which the engine lives.
    """
    try:
        check_case(case)
        chosen = engine(case.engine)
    except BrokenEngineError as error:  # it could be made, and did answer, when the run was planned
        return Evaluation(simulation=failed_simulation(case, str(error)))
    if is_ours(chosen):
        try:
            return measure_simulation(simulate_case(case))
        except HarnessError as error:
            error.add_note(f"It is of the case '{case.label()}'.")
            raise
    verb = "simulate"
    try:
        simulation = simulate_case(case)
        verb = "pickle"
        simulation = pickle.loads(pickle.dumps(simulation))  # noqa: S301 - just made
        verb = "measure"
        return measure_simulation(simulation)
    except LostTaskError:
        raise
    except Exception as error:  # noqa: BLE001 - whatever it is, the other cases go on
        return Evaluation(simulation=failed_simulation(case, describe_exception(error, verb)))


def evaluate_without_truth(case: Case) -> Evaluation:
    """Run a case and measure what needs no comparison with the truth.

    Raises
    ------
    HarnessError
        As `evaluate` does.
    """
    check_case(case)
    simulation = _simulated(case)
    scene, trajectory = case.scene, simulation.trajectory
    return Evaluation(
        simulation=simulation,
        energy_drift=None if trajectory is None else energy_drift(trajectory, scene),
        findings=findings(scene) if trajectory is None and refusal(scene) else (),
        divergence=None if trajectory is None else divergence_of(scene),
    )


def simulate_case(case: Case) -> Simulation:
    """Return an engine's simulation of a case, or a failed one if its adapter broke its contract.

    Raises
    ------
    HarnessError
        For wrong use that only the engine finds when it compiles the case.
    LostTaskError
        If the process dies in which the engine lives.
    """
    chosen = engine(case.engine)
    try:
        answer = chosen.simulate(case)
        reason = contract_violation(answer, case)
    except TrajectoryError as error:
        reason = str(error)
    except (HarnessError, LostTaskError):
        raise
    except Exception as error:  # noqa: BLE001 - whatever it is, the other cases go on
        reason = describe_exception(error)
    return failed_simulation(case, reason) if reason else answer


def failed_simulation(case: Case, reason: str, outcome: Outcome = Outcome.BROKEN) -> Simulation:
    """Return the simulation of a case that has no motion, with the reason as its note."""
    step = None
    with suppress(Exception):  # an adapter that broke its contract once may do it again
        step = timestep_of(case)
    return Simulation(
        case=case,
        outcome=outcome,
        note=reason,
        trajectory=None,
        engine_version=engine_version(case.engine),
        model=case.engine,
        timestep=step,
    )


def measure_simulation(simulation: Simulation) -> Evaluation:
    """Measure a simulation, against the truth where the reference can carry its scene."""
    scene, trajectory = simulation.case.scene, simulation.trajectory
    if trajectory is None:
        return Evaluation(simulation=simulation, findings=findings(scene) if refusal(scene) else ())
    own_motion = motion(trajectory, scene)
    measured = Evaluation(
        simulation=simulation,
        motion=own_motion,
        bounces=bounces(own_motion, scene.can),
        energy_drift=energy_drift(trajectory, scene),
        contact=contact_quality(own_motion),
        findings=findings(scene),
    )
    if refusal(scene):
        return measured
    own = truth(scene)
    exact = _until(scene, own, float(own_motion.time[-1]))
    common = own_motion.time <= exact.ends
    compared = own_motion if common.all() else motion(take(trajectory, common), scene)
    true = motion(exact.at(compared.time), scene)
    dense = sample_truth(exact)
    if simulation.case.profile == RECORDED:  # which may be nearer to the locus than a chord of it
        dense = exact.at(np.union1d(dense.time, compared.time))
    borne = (dense.contact_count > 0) & (dense.contact_force[:, 2] != 0.0)  # not in flight
    before = borne & (dense.time < compared.time[-1])
    # to the very end of what is compared: cut at a sample, the curve would be too short
    last = true.trajectory.contact_point[-1:, :2]
    last = last[true.trajectory.contact_count[-1:] > 0]
    locus = np.vstack((dense.contact_point[before, :2], last))
    chaos = divergence_of(scene)
    chaotic = chaos is not None and chaos.chaotic
    parted = rotation_between(compared.trajectory.quaternion, true.trajectory.quaternion) > PARTED
    pull = dense.contact_force[dense.time <= own.ends, 2] < -_NONE * scene.can.mass * scene.gravity
    own_errors = None if chaotic else errors(compared, true, measured.bounces, own.bounces, locus)
    return replace(
        measured,
        truth=true,
        true_bounces=own.bounces,
        errors=own_errors,
        truth_pulls=bool(pull.any()) and not is_constraint(simulation.case.engine),
        divergence=chaos,
        parts_at=float(compared.time[parted][0]) if parted.any() else None,
    )


def _until(scene: Scene, own: Truth, end: float) -> Truth:
    """Return the truth up to a time in s that an engine may have needed beyond the horizon.

    The times asked for go up in steps, so that the cases of a scene share a solution.
    """
    seconds = own.ends
    while 0.0 < seconds < end:
        seconds *= 1.25
    return own if seconds == own.ends else truth(scene, seconds)
