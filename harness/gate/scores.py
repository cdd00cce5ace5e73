"""The score of a run, against which a later one is held: its ending, numbers and their spread.

Which case a result belongs to, whatever version of an engine made it.

A case's digest names a version of its engine, so that results of two versions never share one. Here
they must meet: a case is what the suite designed, without the settings that a run put on top of it.

The quantities that are held against accepted ones; of each, smaller is better.

A floor is what round-off alone makes of a quantity that is zero in exact arithmetic: some 1e6 steps
that each add 1e-16 of its scale, in no order. Below its floor nothing counts as a change.
"""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

from harness.core.case import Case
from harness.core.simulation import Outcome
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import QUANTITIES as REGISTRY
from harness.metrics.quantities import Number
from harness.studies.comparison.tables import results
from models.scene import Scene


@dataclass(frozen=True, slots=True, kw_only=True, order=True)
class CaseIdentity:
    """A case as it was asked for, whatever version of an engine ran it.

    Parameters
    ----------
    scene, engine, profile : str
    timestep : float
        s; zero for the profile's own, which may differ from version to version.
    options : str
        Settings of the suite's own on top of the profile, as `name=value`, with spaces between.
    """

    scene: str
    engine: str
    profile: str
    timestep: float = 0.0
    options: str = ""

    def label(self) -> str:
        """Return the case in a few words."""
        step = "its own timestep" if self.timestep == 0.0 else f"{self.timestep:g} s"
        return " ".join(
            word
            for word in (f"{self.scene} in {self.engine} ({self.profile}, {step})", self.options)
            if word
        )


def identity(case: Case) -> CaseIdentity:
    """Return the identity of a case as a suite designed it."""
    return CaseIdentity(
        scene=case.scene.name,
        engine=case.engine,
        profile=case.profile,
        timestep=case.timestep or 0.0,
        options=" ".join(f"{name}={value}" for name, value in case.options),
    )


def scene_digest(scene: Scene) -> str:
    """Return 16 hexadecimal digits that name the motion which a scene asks for.

    Name and citation do not move the can.
    """
    motion = {k: v for k, v in scene.to_dict().items() if k not in {"name", "cite"}}
    text = json.dumps(motion, sort_keys=True, default=repr)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


class QuantityKind(Enum):
    """What a quantity speaks of, which decides when it is judged."""

    ERROR = "distance from the exact motion"
    CONTACT = "quality of the contact"
    COST = "work that does not depend on the machine"
    TIME = "time on this machine"


@dataclass(frozen=True, slots=True, kw_only=True)
class GatedQuantity:
    """A column of the table of results, and how it is held against an accepted one."""

    column: str
    kind: QuantityKind
    floor: float

    @property
    def words(self) -> str:
        """Return its name in a sentence."""
        label = REGISTRY[self.column].label
        return f"error of the {label}" if self.kind is QuantityKind.ERROR else label

    @property
    def unit(self) -> str:
        """Return its unit; empty for a ratio or a count."""
        return REGISTRY[self.column].unit


_RAD = 1e-12
"""rad: the comparison of orders, too, takes a smaller error for a sum of roundings."""

_DEG = 1e-10
"""deg: the same of a difference of two angles of some hundred degrees."""

_M = 1e-13
"""m: the same of a locus within some radii of 0.04 m."""

_TOUCH_M = 1e-9
"""m: a nanometre; contacts rest micrometres deep, and round-off of a position is 1e-17."""

_SHARE = 1e-4
"""Of the time: a single sample of the short records; one that flips is no change of an engine."""

_ROWS = 16.0
"""Rows of one step with four points and a pyramid each: the last step may fall on either side."""

QUANTITIES = tuple(
    GatedQuantity(column=column, kind=kind, floor=floor)
    for kind, floors in (
        (
            QuantityKind.ERROR,
            {
                "angle_of_turn_error_deg": _DEG,
                "bounce_time_error_s": 1e-13,
                "peak_friction_ratio_error": 1e-10,
                "phi_rms_rad": _RAD,
                "phi_max_rad": _RAD,
                "psi_rms_rad": 10.0 * _RAD,  # psi runs through many turns
                "theta_rms_rad": 10.0 * _RAD,  # and so does theta
                "rotation_rms_rad": 10.0 * _RAD,
                "contact_locus_rms_m": _M,
                "contact_locus_hausdorff_m": _M,
            },
        ),
        (
            QuantityKind.CONTACT,
            {
                "energy_drift": _RAD,
                "max_penetration_m": _TOUCH_M,
                "max_slip_m_s": _TOUCH_M,  # a nanometre a second
                "lift_off_fraction": _SHARE,
                "multi_contact_fraction": _SHARE,
            },
        ),
        (QuantityKind.COST, {"steps": 1.0, "constraint_rows": _ROWS}),  # one step: the last
        (QuantityKind.TIME, {"wall_s": 0.0, "cpu_s": 0.0}),
    )
    for column, floor in floors.items()
)
"""In the order in which they are named where several have changed."""

BY_COLUMN = {quantity.column: quantity for quantity in QUANTITIES}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Score:
    """A run in numbers.

    Parameters
    ----------
    identity : CaseIdentity
    scene_digest : str
        Names the motion that was asked for.
    digest : str
        Names the case in the version of its engine that ran.
    outcome : str
        Name of an `Outcome`.
    truth_pulls : bool
        Whether the exact motion leaves what a contact can do, so that errors say nothing.
    values : mapping of str to float
        By column of `QUANTITIES`, signed; what is unknown is absent.
    members : int
        Perturbed runs that were made beside it.
    spread : mapping of str to float or None
        Largest departure of a member, by column; None where some have a value and others none.
    endings : mapping of str to int
        How often the run and its members ended with which outcome.
    """

    identity: CaseIdentity
    scene_digest: str
    digest: str = ""
    outcome: str
    truth_pulls: bool
    values: Mapping[str, float]
    members: int = 0
    spread: Mapping[str, Number] = field(default_factory=dict)
    endings: Mapping[str, int] = field(default_factory=dict)

    @property
    def finished(self) -> bool:
        """Whether the run reached its horizon."""
        return self.outcome == Outcome.FINISHED.name

    @property
    def may_finish(self) -> bool:
        """Whether it or a member did."""
        return self.finished or self.endings.get(Outcome.FINISHED.name, 0) > 0

    @property
    def may_fail(self) -> bool:
        """Whether it or a member did not."""
        return not self.finished or any(name != Outcome.FINISHED.name for name in self.endings)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scores:
    """The scores of a whole run of a suite, and where they come from.

    Parameters
    ----------
    suite : str
    scores : mapping of CaseIdentity to Score
    versions : mapping of str to str
        Of rockingcan and of each engine that ran.
    made : mapping
        Provenance, as a manifest tells it.
    settings : mapping of str to str
        What the run set on top of the suite's cases, by `engine.name`.
    place : str
        What messages call them: the path that they were read from.
    """

    suite: str
    scores: Mapping[CaseIdentity, Score]
    versions: Mapping[str, str]
    made: Mapping[str, Any] = field(default_factory=dict)
    settings: Mapping[str, str] = field(default_factory=dict)
    place: str = "this run"


def scored(designed: Sequence[Case], evaluations: Sequence[Evaluation]) -> tuple[Score, ...]:
    """Return the scores of evaluations.

    Parameters
    ----------
    designed : sequence of Case
        As the suite has them, in the order of the evaluations: without settings on top.
    evaluations : sequence of Evaluation
    """
    rows = results(evaluations).frame.to_dict("records")
    return tuple(
        score_of_row(
            row,
            identity=identity(case),
            scene=scene_digest(case.scene),
            outcome=e.simulation.outcome.name,
        )
        for case, e, row in zip(designed, evaluations, rows, strict=True)
    )


def score_of_row(
    row: Mapping[Any, Any], *, identity: CaseIdentity, scene: str, outcome: str
) -> Score:
    """Return the score that a row of the table of results tells."""
    known = {quantity.column: row.get(quantity.column) for quantity in QUANTITIES}
    if row.get("turn_resolved") is not True:
        del known["angle_of_turn_error_deg"]  # right up to whole turns only
    return Score(
        identity=identity,
        scene_digest=scene,
        digest=str(row["digest"]),
        outcome=outcome,
        truth_pulls=bool(row["truth_pulls"]),
        values={
            column: float(value)
            for column, value in known.items()
            if isinstance(value, int | float) and math.isfinite(value)
        },
    )
