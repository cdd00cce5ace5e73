"""What the runs of an engine differ by from coarse to fine.

That is the timestep; of an engine that chooses its own steps it is the setting which bounds their
error, as its description says. Whatever goes through timesteps goes through this.
"""

from collections.abc import Sequence
from dataclasses import replace

from harness.core.case import Case
from harness.core.simulation import Simulation
from harness.engines.base import TIMESTEP
from harness.engines.description import Method
from harness.engines.registry import description_of


def finer_by(engine: str) -> str:
    """Return "timestep", or the setting that stands in its place."""
    return description_of(engine).accuracy_setting or TIMESTEP


def takes_timestep(engine: str) -> bool:
    """Whether an engine may be given a timestep, as far as its description says."""
    return finer_by(engine) == TIMESTEP


def chooses_steps(engine: str) -> bool:
    """Whether an engine takes steps of its own choice, in every profile."""
    own = description_of(engine).method is Method.ERROR_CONTROL
    return own or not takes_timestep(engine)


def rungs(engine: str, timesteps: Sequence[float]) -> tuple[float, ...]:
    """Return a ladder of timesteps (s), or the finest of its accuracies, as many."""
    own = description_of(engine).accuracies
    return tuple(timesteps) if takes_timestep(engine) else own[-len(timesteps) :]


def at_rung(case: Case, value: float) -> Case:
    """Return a case with another timestep, s, or with another accuracy in its place."""
    setting = finer_by(case.engine)
    if setting == TIMESTEP:
        return replace(case, timestep=value)
    return replace(case, options=(*case.options, (setting, value)))


def rung_of(case: Case) -> float | None:
    """Return the timestep that a case asks for, s, or the accuracy; None for the profile's own."""
    setting = finer_by(case.engine)
    value = case.timestep if setting == TIMESTEP else dict(case.options).get(setting)
    return value if isinstance(value, float) else None


def fineness(simulation: Simulation) -> float | None:
    """Return the timestep of a run, s, or its accuracy; None of a solver that has neither."""
    setting = finer_by(simulation.case.engine)
    if setting == TIMESTEP:
        return simulation.timestep
    value = simulation.settings.get(setting)
    return value if isinstance(value, float) else rung_of(simulation.case)


def rung_words(simulation: Simulation) -> str:
    """Return the timestep or the accuracy of a run in words; empty where it has neither."""
    value = fineness(simulation)
    if value is None:
        return ""
    return spelled(simulation.case.engine, value)


def spelled(engine: str, value: float) -> str:
    """Return a timestep with its unit, or an accuracy with its name."""
    setting = finer_by(engine)
    return f"{value:.2g} s" if setting == TIMESTEP else f"{setting} {value:.2g}"
