"""What the differences of one case say of one number: error by step, parts, and the verdict."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from harness.core.case import Case
from harness.core.verdict import Status, Verdict
from harness.studies.gradients.design import unit_of
from harness.studies.gradients.fit import ErrorOfSteps, fit_errors

RIGHT, NEAR = 0.01, 0.1
"""Relative error up to which a derivative is right, and near."""

_INSENSITIVE = 1e-3
"""Share of quantity over key: a smaller derivative is compared with this, not with itself."""

_ROUND_OFF = 1e-12
"""Relative noise of a quantity up to which it is round-off, and not the engine's own roughness."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Differences:
    """Differences of a quantity by a key over a ladder of steps.

    Parameters
    ----------
    base : Case
        That is changed.
    key, quantity : str
    exact : float
        The exact derivative, per unit of the key.
    size : float
        Magnitude of the quantity itself.
    values : mapping of float to float or None
        Difference over its step, per unit of the key, by relative step from long to short.
    """

    base: Case
    key: str
    quantity: str
    exact: float
    size: float
    values: Mapping[float, float | None]

    @property
    def unit(self) -> float:
        """What a relative step of one is, in the unit of the key."""
        return unit_of(self.base.scene, self.key)

    @property
    def scale(self) -> float:
        """What errors are relative to: the derivative, or of one next to nothing a share of Q/x."""
        return max(abs(self.exact), _INSENSITIVE * self.size / self.unit)

    @cached_property
    def errors(self) -> dict[float, float | None]:
        """Relative errors by step."""
        return {
            step: None if value is None else abs(value - self.exact) / self.scale
            for step, value in self.values.items()
        }

    @property
    def best(self) -> tuple[float, float] | None:
        """The step with the smallest error, and that error; None if no difference is known."""
        known = [(error, step) for step, error in self.errors.items() if error is not None]
        return min(known)[::-1] if known else None

    @property
    def usable(self) -> tuple[float, float] | None:
        """The shortest and the longest step at which the derivative is right; None without any."""
        good = [step for step, error in self.errors.items() if error is not None and error <= RIGHT]
        return (min(good), max(good)) if good else None

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
        """The step whose difference is nearest to that of the next shorter one, and its error.

        It is chosen without knowledge of the exact derivative.
        """
        known = [(step, value) for step, value in self.values.items() if value is not None]
        pairs = [(abs(value - after), step) for (step, value), (_, after) in pairwise(known)]
        if not pairs:
            return None
        step = min(pairs)[1]
        error = self.errors[step]
        return None if error is None else (step, error)

    @property
    def noise(self) -> float | None:
        """Noise of the quantity that the differences see, relative to the quantity."""
        if self.parts is None or self.size == 0.0:
            return None
        return 2.0 * self.parts.noise * self.scale * self.unit / self.size

    @property
    def cause(self) -> str:
        """What takes over at short steps; empty if nothing does."""
        noise = self.noise
        if noise is None or self.noise_below is None:
            return ""
        return "round-off" if noise <= _ROUND_OFF else "roughness of the motion"

    @property
    def verdict(self) -> Verdict:
        """Whether the derivative can be had by differences, and with which steps."""
        best = self.best
        if best is None:
            return Verdict(Status.FAILED, "no bounce, so no derivative")
        step, error = best
        value = self.values[step]
        wrong = value is not None and value * self.exact < 0.0 and error > NEAR
        judged = judge(error, wrong_sign=wrong)
        usable = self.usable
        where = f"at best, with a step of {step:.0e}"
        if usable is not None:
            where += f"; right from {usable[0]:.0e} to {usable[1]:.0e}"
        return Verdict(judged.status, f"{judged.text} {where}")


def judge(error: float, *, wrong_sign: bool) -> Verdict:
    """Return the verdict on a relative error of a derivative."""
    if wrong_sign:
        return Verdict(Status.DEVIATES, f"wrong sign, off by {percent(error)}")
    if error <= RIGHT:
        return Verdict(Status.AGREES, f"right to {percent(error)}")
    kind = "near" if error <= NEAR else "wrong"
    return Verdict(Status.DEVIATES, f"{kind}, off by {percent(error)}")


def percent(error: float) -> str:
    """Return a relative error in percent with two digits, or as a power of ten."""
    if not math.isfinite(error):
        return "an infinite part"
    return f"{100.0 * error:.2g} %" if error >= 1e-6 else f"{error:.1e}"  # noqa: PLR2004 - digits


@dataclass(frozen=True, kw_only=True, eq=False)
class OwnDerivative:
    """A derivative as an engine differentiates itself.

    Parameters
    ----------
    base : Case
    key, quantity : str
    step : str
        Of the engine's own differences, in its own units.
    value, exact, scale : float
        Per unit of the key.
    """

    base: Case
    key: str
    quantity: str
    step: str
    value: float
    exact: float
    scale: float

    @property
    def error(self) -> float:
        """Relative error."""
        return abs(self.value - self.exact) / self.scale

    @property
    def verdict(self) -> Verdict:
        """Whether it is right."""
        return judge(self.error, wrong_sign=self.value * self.exact < 0.0 and self.error > NEAR)
