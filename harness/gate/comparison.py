"""Two sets of scores held against each other, quantity by quantity.

A quantity is larger in one of them if it exceeds the other by more than the tolerance and by more
than a factor. The tolerance is what the quantity moves when nothing has changed, measured; the
factor is what one cares for. The rule is the same whichever of the two is called the first.
"""

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from harness.core.verdict import Status
from harness.metrics.quantities import Number
from harness.results.result import Result
from harness.results.scores import QUANTITIES, CaseIdentity, GatedQuantity, QuantityKind, Score

SPREADS = 4.0
"""Spreads in a tolerance: with few members the largest departure seen is not the largest there is.
Ten further perturbed repeats of 24 short runs, 2,760 departures, raised no alarm."""

FACTOR = 1.1
"""Below a tenth more or less no reader of a report draws another conclusion."""

OUTCOME = "outcome"
"""What the ending of a run is called among the quantities."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Difference:
    """One quantity of one case in both.

    Parameters
    ----------
    identity : CaseIdentity
    quantity : str
        A column of `QUANTITIES`, or `OUTCOME`.
    first, second : float or None
        Magnitudes; None for an outcome and for what is unknown.
    spread, tolerance : float or None
        What was measured, and how much may differ; None where nothing can be decided.
    status : Status
        What has become of it from the first to the second: smaller is better.
    note : str
        What the numbers do not say; may be empty.
    digest : str
        Of the second's case, or of the first's where there is no second.
    """

    identity: CaseIdentity
    quantity: str
    first: Number = None
    second: Number = None
    spread: Number = None
    tolerance: Number = None
    status: Status
    note: str = ""
    digest: str = ""

    @property
    def factor(self) -> Number:
        """Second over first; infinite where the first is zero."""
        if self.first is None or self.second is None:
            return None
        if self.first == 0.0:
            return 1.0 if self.second == 0.0 else math.inf
        return self.second / self.first

    @property
    def severity(self) -> float:
        """How far it has changed, either way: the larger over the smaller; infinite if lost."""
        factor = self.factor
        if factor is None or factor == 0.0:
            return math.inf
        return max(factor, 1.0 / factor)


def differences(
    first: Result,
    second: Result,
    *,
    expected: Iterable[CaseIdentity] | None = None,
    spreads: Result | None = None,
    not_installed: Collection[str] = (),
) -> tuple[Difference, ...]:
    """Return all differences, case by case in the order of the second, then its missing cases.

    Parameters
    ----------
    first, second : Result
    expected : iterable of CaseIdentity, optional
        Cases of the first that the second should have; all of them if left out.
    spreads : Result, optional
        Whose spreads count too, where the two were measured without.
    not_installed : collection of str
        Engines whose cases the second cannot have: they are not measured, and not missing.
    """
    compared: list[Difference] = []
    known, own, lent = first.scores, second.scores, spreads.scores if spreads else {}
    for name, score in own.items():
        accepted = known.get(name)
        if accepted is None:
            compared.append(_of_outcome(score, Status.NEW))
        elif first.inputs[name.scene] != second.inputs[name.scene]:
            note = "the scene has changed: they are two motions"
            compared.append(_of_outcome(score, Status.NOT_JUDGED, note))
        else:
            borrowed = lent.get(name)
            sides = [accepted, score] if borrowed is None else [accepted, score, borrowed]
            compared += _case(accepted, score, sides)
    due = known if expected is None else expected
    missing = [known[name] for name in due if name not in own]
    return (*compared, *(_absent(score, not_installed) for score in missing))


def _absent(score: Score, not_installed: Collection[str]) -> Difference:
    """Return the difference of a case that the second does not have."""
    engine = score.identity.engine
    if engine in not_installed:
        return _of_outcome(score, Status.NOT_MEASURED, f"{engine} is not installed")
    return _of_outcome(score, Status.MISSING)


def _of_outcome(score: Score, status: Status, note: str = "") -> Difference:
    """Return the difference of a case as a whole."""
    return Difference(
        identity=score.identity, quantity=OUTCOME, status=status, note=note, digest=score.digest
    )


def _case(first: Score, second: Score, sides: Sequence[Score]) -> Iterator[Difference]:
    """Yield the differences of a case that both have; `sides` are all whose members count."""
    yield _of_outcome(second, *_ending(first, second, sides))
    if not (first.finished and second.finished):
        return  # numbers of runs of other lengths
    for quantity in QUANTITIES:
        a, b = (s.values.get(quantity.column) for s in (first, second))
        if a is not None or b is not None:
            difference = _quantity(second, quantity, a, b, [s.spread for s in sides if s.members])
            if quantity.kind is QuantityKind.TIME:
                note = "machines are noisy: times are not judged"
                difference = replace(difference, status=Status.NOT_JUDGED, note=note)
            elif quantity.kind is QuantityKind.ERROR and (first.truth_pulls or second.truth_pulls):
                note = "the exact motion asks the plane to pull: not judged"
                difference = replace(difference, status=Status.NOT_JUDGED, note=note)
            yield difference


def _ending(first: Score, second: Score, sides: Sequence[Score]) -> tuple[Status, str]:
    """Return the status of the ending of a run, and a note."""
    if first.outcome == second.outcome:
        return Status.SAME, ""
    note = f"{_word(first.outcome)}, then {_word(second.outcome)}"
    if first.finished == second.finished:
        return Status.NOT_JUDGED, note
    if any(s.may_finish and s.may_fail for s in sides):
        swings = "some releases that differ by 1e-9 or less finish and others do not"
        return Status.UNDECIDABLE, f"{note}: {swings}"
    return (Status.BETTER if second.finished else Status.WORSE), note


def _word(outcome: str) -> str:
    return outcome.lower().replace("_", " ")


def _quantity(
    second: Score,
    quantity: GatedQuantity,
    a: Number,
    b: Number,
    measured: Sequence[Mapping[str, Number]],
) -> Difference:
    """Return the difference of one quantity that at least one of the two has."""
    known = [spread[quantity.column] for spread in measured if quantity.column in spread]
    widths = [width for width in known if width is not None]
    spread = None if len(widths) < len(known) else max(widths, default=0.0)
    tolerance = None if spread is None else SPREADS * spread + quantity.floor
    first, then = (None if value is None else abs(value) for value in (a, b))
    status, note = judge(first, then, tolerance)
    return Difference(
        identity=second.identity,
        quantity=quantity.column,
        first=first,
        second=then,
        spread=spread,
        tolerance=tolerance,
        status=status,
        note=note,
        digest=second.digest,
    )


def judge(first: Number, second: Number, tolerance: Number) -> tuple[Status, str]:
    """Return the status of a magnitude, and a note.

    Parameters
    ----------
    first, second : float or None
        Not negative; None for what is unknown.
    tolerance : float or None
        None where releases that no one can tell apart do not agree whether it can be known.
    """
    if tolerance is None:
        return Status.UNDECIDABLE, "some releases that differ by 1e-9 or less do not show it at all"
    if second is None:
        return Status.MISSING, "can no longer be told from the record"
    if first is None:
        return Status.NEW, "could not be told from the record"
    low, high = sorted((first, second))
    if not high > low + tolerance:
        return Status.SAME, ""
    if not high > FACTOR * low:
        return Status.SAME, "moved by less than a tenth"
    return (Status.WORSE if second > first else Status.BETTER), ""
