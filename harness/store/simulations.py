"""What a store's record says of a simulation: everything but its trajectory."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from harness.case import Case
from harness.simulation import Outcome, ParityRow, Simulation
from harness.trajectory import Trajectory

_AS_THEY_ARE = (
    "note",
    "engine_version",
    "model",
    "timestep",
    "steps",
    "constraint_rows",
    "setup_s",
    "wall_s",
    "cpu_s",
    "static_penetration",
)


def record_of(simulation: Simulation) -> dict[str, Any]:
    """Return what is kept of a simulation; times are those that were measured."""
    record: dict[str, Any] = {name: getattr(simulation, name) for name in _AS_THEY_ARE}
    record["outcome"] = simulation.outcome.name
    record["settings"] = dict(simulation.settings)
    record["parity"] = [asdict(row) for row in simulation.parity]
    return record


def simulation_of(
    case: Case, record: Mapping[str, Any], trajectory: Trajectory | None
) -> Simulation:
    """Return the simulation of a case that was kept.

    Raises
    ------
    KeyError, TypeError
        If the record is not one of a simulation.
    """
    told = dict(record)
    return Simulation(
        case=case,
        outcome=Outcome[told.pop("outcome")],
        parity=tuple(ParityRow(**row) for row in told.pop("parity")),
        trajectory=trajectory,
        **told,
    )
