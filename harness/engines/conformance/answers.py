"""What an engine hands over: a sound simulation, with the settings in force, that travels."""

import pickle

from harness.engines.base import resolve
from harness.engines.conformance.bench import Bench
from harness.engines.conformance.fingerprint import fingerprint
from harness.engines.conformance.verdict import Found, holds
from harness.simulation import Outcome


def trajectory(bench: Bench) -> Found:
    """Run the brief release: it ends at its horizon, with a trajectory that is sound."""
    case = bench.case(bench.brief)
    samples = len(bench.trajectory(case))
    outcome = bench.run(case).outcome
    finished = outcome is Outcome.FINISHED
    return holds("" if finished else f"ended with {outcome.value}", f"{samples} samples")


def reported(bench: Bench) -> Found:
    """Compare what a simulation says of itself with what was asked."""
    case = bench.case(bench.brief)
    simulation, engine = bench.run(case), bench.engine
    timestep = engine.timestep(case)
    asked = resolve(case, engine.settings, timestep or 0.0)
    wrong = []
    if dict(simulation.settings) != asked:
        different = {
            key
            for key in asked.keys() | simulation.settings.keys()
            if asked.get(key, ...) != simulation.settings.get(key, ...)
        }
        wrong.append(f"settings differ in {', '.join(sorted(different))}")
    if simulation.timestep != timestep:
        wrong.append(f"timestep {simulation.timestep} instead of {timestep}")
    if simulation.engine_version != engine.version:
        wrong.append(f"version {simulation.engine_version} instead of {engine.version}")
    if simulation.steps < (1 if bench.steps else 0):  # a closed form takes none
        wrong.append(f"{simulation.steps} steps")
    if min(simulation.setup_s, simulation.wall_s, simulation.cpu_s) < 0.0:
        wrong.append("a negative time")
    return holds("; ".join(wrong), f"{len(asked)} settings, {simulation.steps} steps")


def pickling(bench: Bench) -> Found:
    """Send a simulation through pickle: it goes to and from other processes."""
    simulation = bench.run(bench.case(bench.brief))
    back = pickle.loads(pickle.dumps(simulation))  # noqa: S301 - our own bytes
    if back.case != simulation.case or dict(back.settings) != dict(simulation.settings):
        return holds("the case or its settings changed on the way", "")
    same = fingerprint(back) == fingerprint(simulation)
    return holds("" if same else "the arrays changed on the way", "equal bits")
