"""Record of an error run: named errors and counts, as numbers that a file can hold.

Error runs are not timed for the tables: several run at once, and they read more than timed runs do.
The reference is measured by its own numbers, not by samples of its motion.

The solver's iterations are counted outside of any timed run. Engines report the iterations of a
step, but not of a step in a batch. So the world is placed where the run was at a hundred instants
and steps three times there; the third step, whose solver starts from the forces of the second, is
counted, and stands for the steps around its instant.
"""

import math
from collections.abc import Mapping

import numpy as np

from harness.core.case import Case
from harness.core.simulation import Outcome, Simulation
from harness.engines.base import features_of
from harness.engines.reference.truth import Truth, solve_case, truth
from harness.engines.registry import engine
from harness.engines.remote import call_at_engine
from harness.engines.stepping.horizon import natural_time
from harness.engines.stepping.physics_engine import schedule_of
from harness.evaluation.evaluate import evaluate_case
from harness.evaluation.evaluation import Record
from harness.evaluation.run_cases import failed_evaluation
from harness.execution.worker import LostTaskError
from harness.metrics.motion import shares
from harness.metrics.quantities import QUANTITIES, finite
from models.state import Pose, Twist

RECORDED = {
    "turn_deg": QUANTITIES["turn_error_deg"],
    "phi_rms_rad": QUANTITIES["phi_rms_rad"],
    "phi_max_rad": QUANTITIES["phi_max_rad"],
    "bounce_time_s": QUANTITIES["bounce_time_error_s"],
    "contact_locus_rms_m": QUANTITIES["contact_locus_rms_m"],
    "peak_friction_ratio": QUANTITIES["peak_friction_ratio_error"],
    "energy_drift": QUANTITIES["energy_drift"],
    "rotation_rms_deg": QUANTITIES["rotation_rms_deg"],
}
"""The errors of a record by their names in it."""

_INSTANTS = 100
"""Over a run: the mean is known to a tenth of its spread."""

_STEPS = 3
"""The third step in a row starts from the forces of one that started from forces."""


def iterations(simulation: Simulation) -> float | None:
    """Return the mean iterations of the solver in a step; None if the engine counts none."""
    return call_at_engine(simulation.case.engine, _iterations, simulation)


def _iterations(simulation: Simulation) -> float | None:
    """Return the mean iterations of the solver in a step, where the engine is."""
    case, trajectory = simulation.case, simulation.trajectory
    features = features_of(engine(case.engine))
    count, opens = features.counted_step, features.open
    if count is None or opens is None or trajectory is None or len(trajectory) < _STEPS:
        return None
    world = opens(case)
    places = np.unique(np.linspace(0, len(trajectory) - 2, _INSTANTS).astype(np.int64))
    steps, counts = np.empty(len(places)), np.empty(len(places))
    for number, place in enumerate(places.tolist()):
        quaternion, spin = trajectory.quaternion[place], trajectory.angular_velocity[place]
        stage = schedule_of(simulation)[0].next(quaternion.tolist(), spin.tolist())
        steps[number] = simulation.timestep if stage is None else stage.timestep
        if hasattr(world, "set_timestep"):  # a world of the previous release may lack it
            world.set_timestep(float(steps[number]))
        world.place(
            Pose(position=trajectory.position[place], quaternion=quaternion),
            Twist(velocity=trajectory.velocity[place], angular_velocity=spin),
        )
        counts[number] = [count(world) for _ in range(_STEPS)][-1]
    weight = np.diff(trajectory.time)[places] / steps
    return float(np.sum(weight * counts) / np.sum(weight))


_AT_A_TIME = 2000
"""Instants at which a reference model without a locus is held against the truth."""


def measured(case: Case) -> Record:
    """Run a case and return its record.

    Returns
    -------
    dict
        `outcome`, `note`, `version`, `model`, `timestep_s`, `steps`, `constraint_rows`,
        `solver_iterations`, `simulated_s`, `cpu_s`, `compile_s` and `setup_s` of this one run,
        `errors` by name, `command`. None stands for an unknown number.

    Raises
    ------
    HarnessError
        For wrong use, as `evaluate_case` does.
    """
    evaluation = evaluate_case(case)
    own_errors = {name: quantity.of_run(evaluation) for name, quantity in RECORDED.items()}
    simulated = None if evaluation.motion is None else float(evaluation.motion.time[-1])
    if case.engine == "reference" and evaluation.simulation.outcome is Outcome.FINISHED:
        own, exact = solve_case(case), truth(case.scene)
        own_errors |= _of_solution(own, exact)
        simulated = own.ends
    return _record(evaluation.simulation, simulated, own_errors)


def lost_errors(case: Case, error: LostTaskError) -> Record:
    """Return the record of a case whose process died or was stopped: the reason, and no errors."""
    return _record(failed_evaluation(case, error).simulation, None, {})


def _record(
    simulation: Simulation, simulated: float | None, own_errors: Mapping[str, float | None]
) -> Record:
    each = iterations(simulation) if simulation.steps else None
    return {
        "outcome": simulation.outcome.name,
        "note": simulation.note,
        "version": simulation.engine_version,
        "model": simulation.model,
        "timestep_s": simulation.timestep,
        "steps": simulation.steps,
        "constraint_rows": simulation.constraint_rows,
        "solver_iterations": None if each is None else each * simulation.steps,
        "simulated_s": simulated,
        "cpu_s": simulation.cpu_s,
        "compile_s": simulation.compile_s,
        "setup_s": simulation.setup_s,
        "errors": {name: finite(value) for name, value in own_errors.items()},
        "command": _command(simulation),
    }


LOST = frozenset({"BROKEN", "CRASHED", "HUNG", "OUT_OF_MEMORY", "STOPPED"})
"""Outcomes of cases that did not return: they are not run again for their time."""


def _command(simulation: Simulation) -> str:
    """Return the command line that shows the numbers of a case again, also without a motion."""
    case = simulation.case
    if case.engine == "reference" and simulation.trajectory is None:
        words = [f"--{name} {value}" for name, value in case.options]
        return " ".join(["rockingcan reference", case.scene.name, *words])
    return case.command()


def _of_solution(own: Truth, exact: Truth) -> dict[str, float | None]:
    """Return the errors of a solution that knows its bounces and its angles at any instant."""
    T, end = natural_time(own.scene), min(own.ends, exact.ends)
    times = np.linspace(0.0, end, _AT_A_TIME)
    off = own.solution.at(times / T).phi - exact.solution.at(times / T).phi
    own_errors: dict[str, float | None] = {
        "phi_rms_rad": math.sqrt(float(np.sum(shares(times) * off**2))),
        "phi_max_rad": float(np.abs(off).max()),
    }
    if own.bounces and exact.bounces:
        mine, true = own.bounces[0], exact.bounces[0]
        own_errors |= {
            "turn_deg": math.degrees(mine.angle_of_turn - true.angle_of_turn),
            "bounce_time_s": mine.time - true.time,
            "peak_friction_ratio": mine.peak_friction_ratio - true.peak_friction_ratio,
        }
    return own_errors
