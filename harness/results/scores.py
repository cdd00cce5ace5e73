"""The score of a case: how its run ended, its numbers and their spread, and its division.

Which case a score belongs to, whatever version of an engine made it: a case's digest names a
version of its engine, so that results of two versions never share one. Here they must meet: a case
is what the suite designed, without the settings that a run put on top of it.

The quantities that are held against accepted ones; of each, smaller is better.

A floor is what round-off alone makes of a quantity that is zero in exact arithmetic: some 1e6 steps
that each add 1e-16 of its scale, in no order. Below its floor nothing counts as a change.
"""

import hashlib
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from enum import Enum
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, WithJsonSchema

from harness.core.case import Case
from harness.core.simulation import Outcome
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import QUANTITIES as REGISTRY
from harness.metrics.quantities import Number
from harness.studies.comparison.tables import results
from models.scene import Scene


class Division(Enum):
    """What was asked of an engine; cases of two divisions are never compared or ranked together."""

    AS_SHIPPED = "as shipped"
    """The profile `default`, at the engine's own timestep."""

    MATCHED = "matched"
    """The profiles `matched` and `adaptive` with the settings of the suite."""

    OPEN = "open"
    """Any profile, with settings that the run put on top; the result has them."""


def division_of(engine: str, profile: str, settings: Iterable[str]) -> Division:
    """Return the division of a case.

    Parameters
    ----------
    engine, profile : str
    settings : iterable of str
        What the run put on top of the suite's cases, as `engine.name`.
    """
    # an engine's name may have dots: those of a version
    if any(setting.rpartition(".")[0] == engine for setting in settings):
        return Division.OPEN
    return Division.AS_SHIPPED if profile == "default" else Division.MATCHED


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


class Part(BaseModel):
    """A part of a result: frozen, of exactly the declared types and keys, finite numbers alone."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid", allow_inf_nan=False)


def _columns(values: Mapping[str, Number]) -> Mapping[str, Number]:
    if unknown := sorted(set(values) - set(BY_COLUMN)):
        raise ValueError(f"no quantity is called {', '.join(unknown)}")
    return values


def _endings(endings: Mapping[str, int]) -> Mapping[str, int]:
    if unknown := sorted(set(endings) - set(Outcome.__members__)):
        raise ValueError(f"no outcome is called {', '.join(unknown)}")
    return endings


def _outcome(name: str) -> str:
    return next(iter(_endings({name: 1})))


def _object(names: Iterable[str], value: dict[str, object]) -> WithJsonSchema:
    """Return the schema of an object whose keys are some names."""
    keys = {"enum": list(names)}
    return WithJsonSchema({"type": "object", "propertyNames": keys, "additionalProperties": value})


_NUMBER: dict[str, object] = {"type": "number"}
_NUMBER_OR_NULL: dict[str, object] = {"anyOf": [_NUMBER, {"type": "null"}]}
_COUNT: dict[str, object] = {"type": "integer", "minimum": 1}

Digest = Annotated[str, Field(pattern="^[0-9a-f]{16}$")]

_CONTROLS = r"\u0000-\u001f\u007f-\u009f"
_LINES_AND_DIRECTIONS = r"\u2028\u2029\u202a-\u202e\u2066-\u2069"

Line = Annotated[str, Field(max_length=10_000, pattern=f"^[^{_CONTROLS}{_LINES_AND_DIRECTIONS}]*$")]
"""Words on one line: they are shown in a terminal and on a page, which they cannot turn about."""


class Score(Part):
    """A run in numbers; also a line of a file of results.

    Parameters
    ----------
    scene, engine : str
    profile : str
    timestep : float
        s; zero for the profile's own.
    options : str
        See `CaseIdentity`.
    division : Division
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

    scene: Line
    engine: Line
    profile: Literal["default", "matched", "adaptive"]
    timestep: Annotated[float, Field(ge=0.0)] = 0.0
    options: Line = ""
    division: Division
    digest: Digest
    outcome: Annotated[
        str,
        AfterValidator(_outcome),
        WithJsonSchema({"type": "string", "enum": list(Outcome.__members__)}),
    ]
    truth_pulls: bool
    values: Annotated[Mapping[str, float], AfterValidator(_columns), _object(BY_COLUMN, _NUMBER)]
    members: Annotated[int, Field(ge=0)] = 0
    spread: Annotated[
        Mapping[str, Number], AfterValidator(_columns), _object(BY_COLUMN, _NUMBER_OR_NULL)
    ] = {}
    endings: Annotated[
        Mapping[str, int], AfterValidator(_endings), _object(Outcome.__members__, _COUNT)
    ] = {}

    @property
    def identity(self) -> CaseIdentity:
        """The case as it was asked for."""
        return CaseIdentity(
            scene=self.scene,
            engine=self.engine,
            profile=self.profile,
            timestep=self.timestep,
            options=self.options,
        )

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


def scored(
    designed: Sequence[Case], evaluations: Sequence[Evaluation], settings: Iterable[str] = ()
) -> tuple[Score, ...]:
    """Return the scores of evaluations.

    Parameters
    ----------
    designed : sequence of Case
        As the suite has them, in the order of the evaluations: without settings on top.
    evaluations : sequence of Evaluation
    settings : iterable of str
        What the run put on top, as `engine.name`.
    """
    rows, on_top = results(evaluations).frame.to_dict("records"), tuple(settings)
    return tuple(
        score_of_row(
            row, identity=identity(case), outcome=e.simulation.outcome.name, settings=on_top
        )
        for case, e, row in zip(designed, evaluations, rows, strict=True)
    )


def score_of_row(
    row: Mapping[Any, Any], *, identity: CaseIdentity, outcome: str, settings: Iterable[str] = ()
) -> Score:
    """Return the score that a row of the table of results tells.

    Raises
    ------
    ValueError
        If the row or the identity is of no case.
    """
    known = {quantity.column: row.get(quantity.column) for quantity in QUANTITIES}
    if row.get("turn_resolved") is not True:
        del known["angle_of_turn_error_deg"]  # right up to whole turns only
    return Score(
        **asdict(identity),
        division=division_of(identity.engine, identity.profile, settings),
        digest=str(row["digest"]),
        outcome=outcome,
        truth_pulls=bool(row["truth_pulls"]),
        values={
            column: float(value)
            for column, value in known.items()
            if isinstance(value, int | float) and math.isfinite(value)
        },
    )
