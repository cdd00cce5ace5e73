"""What a ladder of accuracies delivers in one scene: slope, saturation, worst factor, verdict.

The delivered error is an absolute one in rad, of an angle of about one; the accuracy asked for is a
relative tolerance of the steps, or a share that `eta` allows. That the two are equal is promised by
nobody: what is judged is that the one follows the other, and within which factor.
"""

import math
import statistics
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

from harness.core.verdict import Status, Verdict
from harness.evaluation.evaluation import Record
from harness.metrics.convergence import observed_order
from harness.studies.tolerance.delivered import PULLS
from harness.studies.tolerance.design import Knob
from models.scene import Scene


class Honesty(Enum):
    """How a setting that asks for an accuracy stands to what it delivers; the value is a phrase."""

    HONEST = "honest"
    CAUTIOUS = "delivers more than asked"
    OPTIMISTIC = "optimistic"
    ERRATIC = "does not follow"
    SATURATES = "saturates"
    ROUND_OFF = "always to round-off"
    IDLE = "changes nothing"
    LOST = "loses the motion"
    UNJUDGED = "not judged"

    @property
    def status(self) -> Status:
        """The status of a verdict of this kind."""
        good = {Honesty.HONEST, Honesty.CAUTIOUS, Honesty.ROUND_OFF}
        if self in good:
            return Status.AGREES
        if self is Honesty.UNJUDGED:
            return Status.NOT_MEASURED
        return Status.FAILED if self is Honesty.LOST else Status.DEVIATES


TRUE_WITHIN = 10.0
"""Delivered over asked up to which a setting is honest: a local error adds up over some steps."""

MUCH_LESS = 0.01
"""Delivered over asked below which, everywhere, more is delivered than asked."""

FOLLOWS = 1.0 / 3.0
"""Slope below which a decade asked for buys less than half a decade."""

_BUYS = 3.0
"""By which the error has to fall, somewhere finer, or it does not respond any more."""

_FAR = 99.0
"""Asked over the finest asked that must have bought nothing: two decades, but for round-off."""

_EPS = 2.0**-52
"""An error that is zero counts as this in a geometric mean."""

_FEWEST = 3
"""Errors from which a slope, or its absence, can be told."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ToleranceLadder:
    """The errors that a setting delivers in a scene.

    Parameters
    ----------
    knob : Knob
    scene : Scene
    measure : str
        Which error it is.
    floor : float
        What round-off allows of the exact motion, rad.
    records : mapping of float to Record
        By what was asked for, from coarse to fine.
    unpaid : tuple of float
        Finer values that were not run.
    because : str
        Why they were not; empty if all were.
    excluded : str
        Why nothing was run; empty if something was, or could not be paid for.
    """

    knob: Knob
    scene: Scene
    measure: str
    floor: float
    records: Mapping[float, Record]
    unpaid: tuple[float, ...] = ()
    because: str = ""
    excluded: str = ""

    @property
    def known(self) -> tuple[tuple[float, float], ...]:
        """Pairs of what was asked for and what was delivered, rad, from coarse to fine."""
        return tuple(
            (asked, float(record["error"]))
            for asked, record in self.records.items()
            if record["error"] is not None
        )

    @property
    def missed(self) -> tuple[tuple[float, str], ...]:
        """Values for which no error is known, each with the reason."""
        return tuple(
            (asked, str(record["reason"]))
            for asked, record in self.records.items()
            if record["error"] is None
        )

    @property
    def saturation(self) -> tuple[float, float] | None:
        """From which value on the error falls no further, and its level there, rad; or None.

        A coarsest error that is small by chance, where it crosses zero, begins no level: finer
        errors above round-off are then larger by as much as counts for a fall.
        """
        known = self.known
        for place, (asked, error) in enumerate(known):
            rest = [each for _, each in known[place:]]
            if asked < _FAR * known[-1][0]:
                return None
            level = place > 0 or max(rest) <= max(_BUYS * error, self.floor)
            if level and min(rest) * _BUYS >= error:
                logs = [math.log(max(each, _EPS)) for each in rest]
                return asked, math.exp(sum(logs) / len(logs))
        return None

    @property
    def responding(self) -> tuple[tuple[float, float], ...]:
        """The known pairs above round-off, up to where the error falls no further."""
        level = self.saturation
        last = 0.0 if level is None else level[0]
        return tuple(
            (asked, error) for asked, error in self.known if asked >= last and error > self.floor
        )

    @property
    def slope(self) -> float | None:
        """Slope of log delivered over log asked where it responds; 1 is in proportion."""
        pairs = self.responding
        if len(pairs) < _FEWEST:
            return None
        return observed_order([a for a, _ in pairs], [e for _, e in pairs]).order

    @property
    def worst(self) -> tuple[float, float] | None:
        """Largest delivered over asked, and what was asked; or None.

        Below round-off of the exact motion nothing is compared.
        """
        pairs = [(error / asked, asked) for asked, error in self.known if error > self.floor]
        return max(pairs) if pairs else None

    @property
    def worst_responding(self) -> float | None:
        """Likewise where the error still follows what is asked."""
        return max((error / asked for asked, error in self.responding), default=None)

    @property
    def finest(self) -> float | None:
        """Delivered over asked at the finest value with an error above round-off."""
        pairs = [(asked, error) for asked, error in self.known if error > self.floor]
        return pairs[-1][1] / pairs[-1][0] if pairs else None

    @property
    def honesty(self) -> Honesty:  # noqa: PLR0911 - a return a kind
        """The kind of verdict, the gravest that holds."""
        reasons = [reason for _, reason in self.missed]
        if not self.records or PULLS in reasons:
            return Honesty.UNJUDGED
        if reasons:
            return Honesty.LOST
        if len(self.known) < _FEWEST:
            return Honesty.UNJUDGED
        level, worst = self.saturation, self.worst_responding
        everywhere = level is not None and level[0] == self.known[0][0]
        if level is not None and level[1] > TRUE_WITHIN * max(self.floor, self.known[-1][0]):
            return Honesty.IDLE if everywhere else Honesty.SATURATES
        if level is not None and everywhere:
            return Honesty.ROUND_OFF if level[1] <= self.floor else Honesty.CAUTIOUS
        if worst is not None and worst > TRUE_WITHIN:
            return Honesty.OPTIMISTIC
        if worst is None or worst < MUCH_LESS:
            return Honesty.CAUTIOUS
        if self.slope is not None and self.slope < FOLLOWS:
            return Honesty.ERRATIC
        return Honesty.HONEST

    @property
    def verdict(self) -> Verdict:
        """The verdict with its numbers."""
        kind = self.honesty
        rest = (
            f"; below {min(self.records):.1g} not paid for" if self.unpaid and self.records else ""
        )
        return Verdict(kind.status, f"{kind.value}: {self._because(kind)}{rest}")

    def _because(self, kind: Honesty) -> str:
        """Return the numbers behind a kind of verdict."""
        level, worst, slope = self.saturation, self.worst, self.slope
        if kind is Honesty.UNJUDGED:
            return self._why_not_judged()
        if kind is Honesty.LOST:
            ((reason, often),) = Counter(reason for _, reason in self.missed).most_common(1)
            return f"at {often} of {len(self.records)} values, {reason}"
        if kind in {Honesty.IDLE, Honesty.ROUND_OFF} and level is not None:
            return f"{level[1]:.1e} rad whatever is asked for"
        if kind is Honesty.SATURATES and level is not None:
            return f"from {level[0]:.0e} on the error stays at {level[1]:.1e} rad"
        if worst is None:
            return "round-off at every value"
        steep = "" if slope is None else f", slope {slope:.2f}"
        return f"at worst {worst[0]:.2g} times what {worst[1]:.0e} asks for{steep}"

    def _why_not_judged(self) -> str:
        if not self.records:
            return self.excluded or "no value can be paid for"
        return self.missed[0][1] if self.missed else "too few errors to tell a slope from"


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingSummary:
    """What one setting delivers over all scenes."""

    knob: Knob
    ladders: tuple[ToleranceLadder, ...]

    @property
    def asked(self) -> tuple[float, float] | None:
        """Coarsest and finest value that was asked for; None if nothing could be run."""
        values = [asked for each in self.ladders for asked in each.records]
        return (max(values), min(values)) if values else None

    @property
    def counts(self) -> Counter[Honesty]:
        """How many scenes have which kind of verdict."""
        return Counter(each.honesty for each in self.ladders)

    @property
    def slope(self) -> float | None:
        """Median of the slopes."""
        known = [each.slope for each in self.ladders if each.slope is not None]
        return statistics.median(known) if known else None

    @property
    def worst(self) -> tuple[float, float, str] | None:
        """Largest delivered over asked, what was asked, and in which scene."""
        known = [(*each.worst, each.scene.name) for each in self.ladders if each.worst is not None]
        return max(known, default=None)

    @property
    def level(self) -> tuple[float, str] | None:
        """The highest level at which the error stays above what is asked for, and the scene."""
        kinds = {Honesty.SATURATES, Honesty.IDLE}
        known = [
            (each.saturation[1], each.scene.name)
            for each in self.ladders
            if each.honesty in kinds and each.saturation is not None
        ]
        return max(known, default=None)

    @property
    def verdict(self) -> Verdict:
        """The commonest kind of verdict over the scenes that are judged, and how many have others.

        Its status is that of the commonest kind.
        """
        counts = Counter({k: n for k, n in self.counts.items() if k is not Honesty.UNJUDGED})
        if not counts:
            return Verdict(Honesty.UNJUDGED.status, "not judged in any scene")
        kind, often = counts.most_common(1)[0]
        total = counts.total()
        text = f"{kind.value} in {often} of {total}"
        others = ", ".join(f"{k.value} in {n}" for k, n in counts.most_common()[1:])
        return Verdict(kind.status, f"{text}; {others}" if others else text)


def by_setting(ladders: Sequence[ToleranceLadder]) -> tuple[SettingSummary, ...]:
    """Return the ladders of each setting together, in the order of first appearance."""
    return tuple(
        SettingSummary(knob=knob, ladders=tuple(each for each in ladders if each.knob == knob))
        for knob in dict.fromkeys(each.knob for each in ladders)
    )
