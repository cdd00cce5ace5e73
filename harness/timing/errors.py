"""What an error run leaves: named errors and counts, as numbers that a file can hold.

Error runs are not timed for the tables: they run beside each other, and read what timing leaves
out. The reference is measured by its own numbers, not by samples of them.
"""

import math

import numpy as np

from harness.case import Case
from harness.engines.horizon import natural_time
from harness.engines.reference import Truth, solved, truth
from harness.isolation import LostTaskError
from harness.metrics.motion import shares
from harness.runner import Evaluation, attempt, lost
from harness.simulation import Simulation
from harness.timing.iterations import iterations
from harness.timing.record import Record

_AT_A_TIME = 2000
"""Instants at which a reference model without a locus is held against the truth."""


def measured(case: Case) -> Record:
    """Run a case and return what is known of it.

    Parameters
    ----------
    case : Case

    Returns
    -------
    dict
        `outcome`, `note`, `version`, `model`, `timestep_s`, `steps`, `constraint_rows`,
        `solver_iterations`, `simulated_s`, `cpu_s` and `setup_s` of this one run, `errors` by name,
        `command`. None is not known.

    Raises
    ------
    HarnessError
        For wrong use, as `attempt` does.
    """
    evaluation = attempt(case)
    simulation = evaluation.simulation
    found: dict[str, float | None] = _of_evaluation(evaluation)
    simulated = None if evaluation.motion is None else float(evaluation.motion.time[-1])
    cpu = simulation.cpu_s
    if case.engine == "reference" and simulation.outcome.name == "FINISHED":
        own, exact = solved(case), truth(case.scene)
        found |= _of_solution(own, exact)
        simulated = own.ends
    return {
        "outcome": simulation.outcome.name,
        "note": simulation.note,
        "version": simulation.engine_version,
        "model": simulation.model,
        "timestep_s": simulation.timestep,
        "steps": simulation.steps,
        "constraint_rows": simulation.constraint_rows,
        "solver_iterations": _iterations(simulation),
        "simulated_s": simulated,
        "cpu_s": cpu,
        "setup_s": simulation.setup_s,
        "errors": {name: _finite(value) for name, value in found.items()},
        "command": _command(simulation),
    }


def lost_errors(case: Case, error: LostTaskError) -> Record:
    """Return what is known of a case whose process died or was stopped: why."""
    simulation = lost(case, error).simulation
    return {
        "outcome": simulation.outcome.name,
        "note": simulation.note,
        "version": simulation.engine_version,
        "model": simulation.model,
        "timestep_s": simulation.timestep,
        "steps": 0,
        "constraint_rows": 0,
        "solver_iterations": None,
        "simulated_s": None,
        "cpu_s": 0.0,
        "setup_s": 0.0,
        "errors": {},
        "command": case.command(),
    }


LOST = frozenset({"BROKEN", "CRASHED", "HUNG", "OUT_OF_MEMORY", "STOPPED"})
"""Outcomes of cases that did not come back: not to be run again for their time."""


def _command(simulation: Simulation) -> str:
    """Return what runs a case again and shows its numbers, also where there is no motion to run."""
    case = simulation.case
    if case.engine == "reference" and simulation.trajectory is None:
        words = [f"--{name} {value}" for name, value in case.options]
        return " ".join(["rockingcan reference", case.scene.name, *words])
    return case.command()


def _of_evaluation(e: Evaluation) -> dict[str, float | None]:
    """Return the errors of a recorded motion; the turn only where it can be counted."""
    found: dict[str, float | None] = {"energy_drift": e.energy_drift}
    if e.errors is None:
        return found
    errors = e.errors
    found |= {
        "phi_rms_rad": errors.phi_rms,
        "phi_max_rad": errors.phi_max,
        "rotation_rms_deg": math.degrees(errors.rotation_rms),
        "contact_locus_rms_m": errors.contact_locus_rms,
    }
    if errors.angle_of_turn:
        turn = math.degrees(errors.angle_of_turn[0])
        found |= {
            "turn_deg": turn if e.bounces[0].resolved else None,
            "bounce_time_s": errors.time_of_bounce[0],
            "peak_friction_ratio": errors.peak_friction_ratio[0],
        }
    return found


def _of_solution(own: Truth, exact: Truth) -> dict[str, float | None]:
    """Return the errors of a solution that knows its bounces and its angles at any instant."""
    T, end = natural_time(own.scene), min(own.ends, exact.ends)
    times = np.linspace(0.0, end, _AT_A_TIME)
    off = own.solution.at(times / T).phi - exact.solution.at(times / T).phi
    found: dict[str, float | None] = {
        "phi_rms_rad": math.sqrt(float(np.sum(shares(times) * off**2))),
        "phi_max_rad": float(np.abs(off).max()),
    }
    if own.bounces and exact.bounces:
        mine, true = own.bounces[0], exact.bounces[0]
        found |= {
            "turn_deg": math.degrees(mine.angle_of_turn - true.angle_of_turn),
            "bounce_time_s": mine.time - true.time,
            "peak_friction_ratio": mine.peak_friction_ratio - true.peak_friction_ratio,
        }
    return found


def _iterations(simulation: Simulation) -> float | None:
    """Return the solver's iterations over the whole run, if they can be counted."""
    trajectory = simulation.trajectory
    if trajectory is None or not simulation.steps:
        return None
    each = iterations(simulation)
    return None if each is None else each * simulation.steps


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None
