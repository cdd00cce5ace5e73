"""An evaluation as a store keeps it: both motions as trajectories, all else as a record.

A motion in the paper's terms follows from its trajectory alone, so that is what is kept.

What names a result of a case in a store: everything that decides it.

What a store's record says of a simulation: everything but its trajectory.
"""

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.core.bounce import Bounce
from harness.core.case import Case
from harness.core.errors import StoreError
from harness.core.simulation import Outcome, ParityRow, Simulation
from harness.core.trajectory import Trajectory
from harness.engines.reference import Finding
from harness.engines.reference.assumption_checks import Divergence
from harness.engines.registry import engine, names
from harness.evaluation.evaluation import Evaluation
from harness.execution.cache import CacheFolder
from harness.execution.cache_entry import Array, EntryContent, Metadata, checksum
from harness.execution.source_fingerprint import fingerprint
from harness.execution.tasks import ResultCache
from harness.metrics.contact import ContactQuality
from harness.metrics.error import Errors
from harness.metrics.motion import motion


def case_key(case: Case, *modules: str) -> str:
    """Return what names a result of a case: the case, its engine's version, and the program.

    Parameters
    ----------
    case : Case
    modules : str
        Names of modules that decide the result besides those that make an evaluation.
    """
    digest = case.digest(engine_version(case.engine))
    return checksum(f"{digest} {code_fingerprint(case.engine, *modules)}".encode())[:32]


def case_metadata(case: Case, *modules: str) -> Metadata:
    """Return where a result of a case comes from."""
    return Metadata(
        label=case.label(),
        command=case.command(),
        engine=case.engine,
        engine_version=engine_version(case.engine),
        code=code_fingerprint(case.engine, *modules),
        modules=(_module_of(case.engine), *modules),
    )


def is_current(told: Metadata) -> bool:
    """Whether a result that is kept can still be found: program and engine are what they were."""
    if told.engine and told.engine not in names():
        return False
    same = not told.engine or engine_version(told.engine) == told.engine_version
    return same and fingerprint(*told.modules) == told.code


def code_fingerprint(name: str, *modules: str) -> str:
    """Return the fingerprint of the program behind results of an engine."""
    return fingerprint(_module_of(name), *modules)


def engine_version(name: str) -> str:
    """Return the version of an engine, or "unknown" if its adapter cannot tell."""
    try:
        version: object = engine(name).version
        return version if isinstance(version, str) else "unknown"
    except Exception:  # noqa: BLE001 - an adapter is somebody's program
        return "unknown"


def _module_of(name: str) -> str:
    """Return the module that an engine comes from."""
    return type(engine(name)).__module__


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


def encode_simulation(simulation: Simulation) -> dict[str, Any]:
    """Return what is kept of a simulation; times are those that were measured."""
    record: dict[str, Any] = {name: getattr(simulation, name) for name in _AS_THEY_ARE}
    record["outcome"] = simulation.outcome.name
    record["settings"] = dict(simulation.settings)
    record["parity"] = [asdict(row) for row in simulation.parity]
    return record


def decode_simulation(
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


_TRUE = "true_"


def evaluation_cache(store: CacheFolder) -> ResultCache[Case, Evaluation]:
    """Return where evaluations are kept."""
    return ResultCache(
        store=store,
        kind="evaluations",
        key=case_key,
        about=case_metadata,
        pack=encode_evaluation,
        unpack=decode_evaluation,
    )


def encode_evaluation(evaluation: Evaluation) -> EntryContent:
    """Return what is kept of an evaluation."""
    e = evaluation
    arrays = _arrays(e.simulation)
    samples = 0
    if e.truth is not None:
        samples = len(e.truth.trajectory)
        arrays |= {
            _TRUE + field.name: _padded(getattr(e.truth.trajectory, field.name), arrays["time"])
            for field in fields(Trajectory)
        }
    return EntryContent(
        record={
            "simulation": encode_simulation(e.simulation),
            "bounces": [asdict(bounce) for bounce in e.bounces],
            "energy_drift": e.energy_drift,
            "contact": None if e.contact is None else asdict(e.contact),
            "true_samples": samples,
            "true_bounces": [asdict(bounce) for bounce in e.true_bounces],
            "errors": None if e.errors is None else asdict(e.errors),
            "truth_pulls": e.truth_pulls,
            "findings": [asdict(finding) for finding in e.findings],
            "divergence": None if e.divergence is None else asdict(e.divergence),
            "parts_at": e.parts_at,
        },
        arrays=arrays,
    )


def decode_evaluation(case: Case, content: EntryContent) -> Evaluation:
    """Return the evaluation of a case that was kept, equal bit for bit to the one that was made.

    Raises
    ------
    StoreError
        If it is not an evaluation that was kept.
    """
    told = content.record
    try:
        trajectory = _trajectory(content.arrays, "")
        true = _trajectory(content.arrays, _TRUE, told["true_samples"])
        return Evaluation(
            simulation=decode_simulation(case, told["simulation"], trajectory),
            motion=None if trajectory is None else motion(trajectory, case.scene),
            bounces=tuple(Bounce(**bounce) for bounce in told["bounces"]),
            energy_drift=told["energy_drift"],
            contact=None if told["contact"] is None else ContactQuality(**told["contact"]),
            truth=None if true is None else motion(true, case.scene),
            true_bounces=tuple(Bounce(**bounce) for bounce in told["true_bounces"]),
            errors=None if told["errors"] is None else Errors(**told["errors"]),
            truth_pulls=told["truth_pulls"],
            findings=tuple(Finding(**finding) for finding in told["findings"]),
            divergence=None if told["divergence"] is None else Divergence(**told["divergence"]),
            parts_at=told["parts_at"],
        )
    except (KeyError, TypeError) as error:
        raise StoreError("it is no evaluation") from error


def _arrays(simulation: Simulation) -> dict[str, Array]:
    """Return the arrays of a simulation by name."""
    trajectory = simulation.trajectory
    if trajectory is None:
        return {}
    return {field.name: getattr(trajectory, field.name) for field in fields(Trajectory)}


def _padded(array: NDArray[Any], like: NDArray[Any]) -> NDArray[Any]:
    """Return an array with zeros at its end, as many samples long as another."""
    short = [(0, len(like) - len(array))] + [(0, 0)] * (array.ndim - 1)
    return np.pad(array, short)


def _trajectory(
    arrays: Mapping[str, Array], prefix: str, samples: int | None = None
) -> Trajectory | None:
    """Return a trajectory out of arrays, or None if it is not among them."""
    if not arrays or samples == 0:
        return None
    found: dict[str, Any] = {
        field.name: arrays[prefix + field.name][:samples] for field in fields(Trajectory)
    }
    return Trajectory(**found)
