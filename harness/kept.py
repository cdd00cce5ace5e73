"""An evaluation as a store keeps it: both motions as trajectories, all else as a record.

A motion in the paper's terms follows from its trajectory alone, so that is what is kept.
"""

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.bounce import Bounce
from harness.campaign import Shelf
from harness.case import Case
from harness.engines.reference import Divergence, Finding
from harness.errors import StoreError
from harness.evaluation import Evaluation
from harness.keys import about, key_of
from harness.metrics.contact import ContactQuality
from harness.metrics.error import Errors
from harness.metrics.motion import motion
from harness.simulation import Simulation
from harness.store import Content, Store
from harness.store.entry import Array
from harness.store.simulations import record_of, simulation_of
from harness.trajectory import Trajectory

_TRUE = "true_"


def evaluations(store: Store) -> Shelf[Case, Evaluation]:
    """Return where evaluations are kept."""
    return Shelf(
        store=store,
        kind="evaluations",
        key=key_of,
        about=about,
        pack=content_of,
        unpack=evaluation_of,
    )


def content_of(evaluation: Evaluation) -> Content:
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
    return Content(
        record={
            "simulation": record_of(e.simulation),
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


def evaluation_of(case: Case, content: Content) -> Evaluation:
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
            simulation=simulation_of(case, told["simulation"], trajectory),
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
