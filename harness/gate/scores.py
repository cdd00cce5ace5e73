"""What is kept of a run to hold a later one against: its ending, its numbers, their spread."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from harness.case import Case
from harness.gate.identity import Identity, identity, scene_digest
from harness.gate.quantities import QUANTITIES
from harness.runner import Evaluation
from harness.simulation import Outcome
from harness.studies.comparison import results

Number = float | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Score:
    """A run in numbers.

    Parameters
    ----------
    identity : Identity
    scene_digest : str
        Names the motion that was asked for.
    outcome : str
        Name of an `Outcome`.
    truth_pulls : bool
        Whether the exact motion leaves what a contact can do, so that errors say nothing.
    values : mapping of str to float
        By column of `QUANTITIES`, signed; what is unknown is absent.
    digest : str
        Names the case in the version of its engine that ran.
    members : int
        Perturbed runs that were made beside it.
    spread : mapping of str to float or None
        Largest departure of a member, by column; None where some have a value and others none.
    endings : mapping of str to int
        How often the run and its members ended with which outcome.
    """

    identity: Identity
    scene_digest: str
    outcome: str
    truth_pulls: bool
    values: Mapping[str, float]
    digest: str = ""
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
    scores : mapping of Identity to Score
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
    scores: Mapping[Identity, Score]
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
        score(
            row,
            identity=identity(case),
            scene=scene_digest(case.scene),
            outcome=e.simulation.outcome.name,
        )
        for case, e, row in zip(designed, evaluations, rows, strict=True)
    )


def score(row: Mapping[Any, Any], *, identity: Identity, scene: str, outcome: str) -> Score:
    """Return the score that a row of the table of results tells."""
    return Score(
        identity=identity,
        scene_digest=scene,
        outcome=outcome,
        truth_pulls=bool(row["truth_pulls"]),
        values=MappingProxyType(dict(_values(row))),
        digest=str(row["digest"]),
    )


def _values(row: Mapping[Any, Any]) -> Iterable[tuple[str, float]]:
    """Yield the numbers of a row that are known; a turn that cannot be counted is not."""
    for quantity in QUANTITIES:
        value = row.get(quantity.column)
        if quantity.column == _TURN and row.get("turn_resolved") is not True:
            continue
        if isinstance(value, int | float) and math.isfinite(value):
            yield quantity.column, float(value)


_TURN = "angle_of_turn_error_deg"
