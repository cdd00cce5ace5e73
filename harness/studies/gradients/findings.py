"""What the differences of one case say of one number: error by step, parts, and the verdict."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from harness.core.case import Case
from harness.core.verdict import Status, Verdict
from harness.studies.gradients.causes import (
    Cause,
    Takeover,
    long_cause,
    longest_run,
    own_causes,
    short_cause,
)
from harness.studies.gradients.design import unit_of
from harness.studies.gradients.fit import ErrorOfSteps, fit_errors

RIGHT, NEAR = 0.01, 0.1
"""Relative error up to which a derivative is right, and near."""

AT_BOUND = "the number is at the bound of its range, and cannot be changed both ways"
"""Why there is no difference at all."""

_INSENSITIVE = 1e-3
"""Share of quantity over key: a smaller derivative is compared with this, not with itself."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Differences:
    """Differences of a quantity by a key over a ladder of steps.

    Parameters
    ----------
    base : Case
        That is changed.
    key, quantity : str
    exact : float or None
        The exact derivative, per unit of the key; None where there is none.
    size : float
        Magnitude of the quantity itself.
    why : str
        Why there is no exact derivative.
    values : mapping of float to float or None
        Difference over its step, per unit of the key, by relative step from long to short.
    chaotic : bool
        Whether disturbances of the motion grow exponentially.
    """

    base: Case
    key: str
    quantity: str
    exact: float | None
    size: float
    values: Mapping[float, float | None]
    why: str = ""
    chaotic: bool = False

    @property
    def unit(self) -> float:
        """What a relative step of one is, in the unit of the key."""
        return unit_of(self.base.scene, self.key)

    @property
    def growth(self) -> float:
        """The exact derivative over a relative change of the key, in the unit of the quantity."""
        return math.nan if self.exact is None else self.exact * self.unit

    @property
    def insensitive(self) -> bool:
        """Whether the exact derivative is next to nothing beside quantity over key."""
        return self.exact is not None and abs(self.exact) < self._least

    @property
    def _least(self) -> float:
        return _INSENSITIVE * self.size / self.unit

    @property
    def scale(self) -> float | None:
        """What errors are relative to: the derivative, or of one next to nothing a share of Q/x."""
        return None if self.exact is None else max(abs(self.exact), self._least)

    @cached_property
    def errors(self) -> dict[float, float | None]:
        """Relative errors by step; None where they are not known."""
        exact, scale = self.exact, self.scale
        if exact is None or not scale:
            return dict.fromkeys(self.values)
        return {
            step: None if value is None else abs(value - exact) / scale
            for step, value in self.values.items()
        }

    @property
    def best(self) -> tuple[float, float] | None:
        """The step with the smallest error, and that error; None if no difference is known."""
        known = [(error, step) for step, error in self.errors.items() if error is not None]
        return min(known)[::-1] if known else None

    @property
    def usable(self) -> tuple[float, float] | None:
        """Shortest and longest step of the longest run of steps that are right; None without one.

        Two neighbours make a run: an error that crosses zero is small at one step by chance.
        """
        steps = list(self.errors)
        right = [error is not None and error <= RIGHT for error in self.errors.values()]
        run = longest_run(np.array(right, dtype=np.bool_))
        return None if run is None else (steps[run[1]], steps[run[0]])

    @cached_property
    def parts(self) -> ErrorOfSteps | None:
        """Truncation, floor and noise; None if too few errors are known."""
        return fit_errors(tuple(self.errors), tuple(self.errors.values()))

    @property
    def noise_below(self) -> float | None:
        """Step below which noise is the largest part; None if no step is as short."""
        below = None if self.parts is None else self.parts.noise_below
        return below if below is not None and below >= min(self.values) else None

    @property
    def truncation_above(self) -> float | None:
        """Step above which truncation is the largest part; None if no step is as long."""
        above = None if self.parts is None else self.parts.truncation_above
        return above if above is not None and above <= max(self.values) else None

    @property
    def settled(self) -> tuple[float, float] | None:
        """The step whose difference changes least with the next shorter one, and its error.

        It is chosen without knowledge of the exact derivative. Two differences of zero settle
        nothing: the quantity no longer resolves the change.
        """
        pairs = [
            (abs(value - after) / max(abs(value), abs(after)), step)
            for (step, value), (_, after) in pairwise(self.values.items())
            if value is not None and after is not None and (value or after)
        ]
        if not pairs:
            return None
        step = min(pairs)[1]
        error = self.errors[step]
        return None if error is None else (step, error)

    @property
    def noise(self) -> float | None:
        """Noise of the quantity that the differences see, relative to the quantity."""
        if self.parts is None or self.size == 0.0 or self.scale is None:
            return None
        return 2.0 * self.parts.noise * self.scale * self.unit / self.size

    @cached_property
    def short(self) -> Cause | None:
        """What is wrong with steps below those that are right; None if nothing is."""
        if self.exact is None or not self.scale:
            return None
        return short_cause(
            tuple(self.values),
            tuple(self.values.values()),
            exact=self.exact,
            scale=self.scale,
            right=RIGHT,
            unit=self.unit,
            size=self.size,
        )

    @cached_property
    def long(self) -> Cause | None:
        """What is wrong with steps above those that are right; None if nothing is."""
        if self.exact is None or not self.scale:
            return None
        return long_cause(
            tuple(self.values),
            tuple(self.values.values()),
            exact=self.exact,
            scale=self.scale,
            right=RIGHT,
            growth=abs(self.growth) / self.size if self.size else math.inf,
            chaotic=self.chaotic,
        )

    def amount(self, error: float) -> str:
        """Return a relative error in words: of the derivative, or of quantity over key."""
        if self.insensitive:
            return (
                f"{percent(error * _INSENSITIVE)} of quantity over key, the exact being next to 0"
            )
        return percent(error)

    @property
    def verdict(self) -> Verdict:
        """Whether the derivative can be had by differences, and with which steps.

        Where no run of steps is right it is judged at the step that settles, since nobody who
        differentiates an engine knows which step happens to be best.
        """
        if self.exact is None:
            return Verdict(Status.NOT_JUDGED, f"not judged: {self.why}")
        if not self.values:
            return Verdict(Status.NOT_JUDGED, f"not judged: {AT_BOUND}")
        usable, chosen = self.usable, self.settled or self.best
        if usable is not None:
            inside = [
                error
                for step, error in self.errors.items()
                if error is not None and usable[0] <= step <= usable[1]
            ]
            words = f"right to {self.amount(max(inside))} with steps from {usable[0]:.0e} to "
            words += f"{usable[1]:.0e}{self._beyond}"
            return Verdict(Status.AGREES, words)
        if chosen is None:
            return Verdict(Status.FAILED, "no bounce, so no derivative")
        step, error = chosen
        value = self.values[step]
        wrong = value is not None and value * self.exact < 0.0 and error > NEAR
        words = _off(error, self.amount(error), wrong_sign=wrong)
        return Verdict(Status.DEVIATES, f"{words} where it settles, at {step:.0e}{self._beyond}")

    @property
    def _beyond(self) -> str:
        """What takes over at shorter and at longer steps, in words, with the steps."""
        ends = (("down", self.short), ("up", self.long))
        return "".join(
            f"; {each.takeover.word} from {each.step:.0e} {way}" for way, each in ends if each
        )


def judge(error: float, *, wrong_sign: bool) -> Verdict:
    """Return the verdict on a relative error of a derivative."""
    if error <= RIGHT and not wrong_sign:
        return Verdict(Status.AGREES, f"right to {percent(error)}")
    return Verdict(Status.DEVIATES, _off(error, percent(error), wrong_sign=wrong_sign))


def _off(error: float, amount: str, *, wrong_sign: bool) -> str:
    kind = "near" if error <= NEAR else "wrong"
    return f"{'wrong sign' if wrong_sign else kind}, off by {amount}"


def percent(error: float) -> str:
    """Return a relative error in percent, with two digits."""
    if not math.isfinite(error):
        return "an infinite part"
    return f"{100.0 * error:.2g} %"


@dataclass(frozen=True, kw_only=True, eq=False)
class OwnDerivative:
    """A derivative as an engine differentiates itself.

    Parameters
    ----------
    base : Case
    settings : str
        That the engine needs on top of the case; empty without any.
    key, quantity : str
    step : str
        Of the engine's own differences, in its own units; "program" of one that takes none.
    value : float or None
        Per unit of the key.
    exact, scale : float or None
        Likewise; None where there is no exact derivative.
    why : str
        Why the engine or the reference has no number.
    cause : Takeover or None
        What is wrong at this step; None where it is right or not judged.
    """

    base: Case
    settings: str
    key: str
    quantity: str
    step: str
    value: float | None
    exact: float | None
    scale: float | None
    why: str
    cause: Takeover | None = None

    @property
    def same(self) -> tuple[object, ...]:
        """What is equal of one derivative by several steps."""
        return self.base, self.settings, self.key, self.quantity

    @property
    def error(self) -> float | None:
        """Relative error; None where it is not judged."""
        if self.value is None or self.exact is None or self.scale is None:
            return None
        return abs(self.value - self.exact) / self.scale

    @property
    def verdict(self) -> Verdict:
        """Whether it is right, or why it is not judged."""
        error = self.error
        if error is None or self.value is None or self.exact is None:
            return Verdict(Status.NOT_JUDGED, f"not judged: {self.why}")
        return judge(error, wrong_sign=self.value * self.exact < 0.0 and error > NEAR)


def with_causes(own: Sequence[OwnDerivative]) -> Iterator[OwnDerivative]:
    """Yield derivatives of engines with what is wrong, which their other steps tell."""
    errors: dict[tuple[object, ...], list[float | None]] = {}
    for each in own:
        errors.setdefault(each.same, []).append(each.error)
    causes = {same: iter(own_causes(ladder, right=RIGHT)) for same, ladder in errors.items()}
    for each in own:
        yield replace(each, cause=next(causes[each.same]))


def over_step(up: float | None, down: float | None, step: float) -> float | None:
    """Return a difference over its step; None if an end is not known."""
    if up is None or down is None or not math.isfinite(up - down):
        return None
    return (up - down) / step
