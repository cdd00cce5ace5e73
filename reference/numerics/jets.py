"""Jets: values with their first derivatives, carried through a formula by the chain rule.

Forward-mode differentiation in arrays. A jet is exact to round-off, of complex values too, and a
formula that loses no digits in its value by cancellation loses none in its derivatives.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias, Union

import numpy as np
from numpy.typing import NDArray

Values: TypeAlias = NDArray[Any]
"""Real or complex numbers."""
Index: TypeAlias = int | slice | tuple[int | slice | None, ...] | None
Operand: TypeAlias = Union["Jet", Values, float]


@dataclass(frozen=True, slots=True, eq=False)
class Jet:
    """Values and their derivatives.

    Attributes
    ----------
    value : ndarray, shape (...)
    slope : ndarray, shape (..., k)
        Derivatives with respect to k numbers; the leading axes broadcast against those of `value`.
    """

    # numpy leaves arithmetic with a jet to the jet
    __array_ufunc__ = None

    value: Values
    slope: Values

    @property
    def real(self) -> "Jet":
        """Return the real parts."""
        return Jet(self.value.real, self.slope.real)

    def __getitem__(self, index: Index) -> "Jet":
        """Return some of the values, by an index of the leading axes."""
        return Jet(self.value[index], self.slope[index])

    def through(self, value: Values, derivative: Values) -> "Jet":
        """Return a function of this jet, from its values and its derivative there."""
        return Jet(value, np.asarray(derivative)[..., None] * self.slope)

    def __neg__(self) -> "Jet":
        """Return the opposite."""
        return Jet(-self.value, -self.slope)

    def __add__(self, other: Operand) -> "Jet":
        """Return a sum."""
        if isinstance(other, Jet):
            return Jet(self.value + other.value, self.slope + other.slope)
        return Jet(self.value + other, self.slope)

    __radd__ = __add__

    def __sub__(self, other: Operand) -> "Jet":
        """Return a difference."""
        return self + (-other)

    def __rsub__(self, other: Operand) -> "Jet":
        """Return a difference."""
        return -self + other

    def __mul__(self, other: Operand) -> "Jet":
        """Return a product."""
        if isinstance(other, Jet):
            slope = self.value[..., None] * other.slope + other.value[..., None] * self.slope
            return Jet(self.value * other.value, slope)
        return self.through(self.value * other, np.asarray(other))

    __rmul__ = __mul__

    def __truediv__(self, other: Operand) -> "Jet":
        """Return a quotient."""
        if isinstance(other, Jet):
            value = self.value / other.value
            slope = (self.slope - value[..., None] * other.slope) / other.value[..., None]
            return Jet(value, slope)
        return self.through(self.value / other, 1 / np.asarray(other))

    def __rtruediv__(self, other: Values | float) -> "Jet":
        """Return a quotient."""
        value = other / self.value
        return self.through(value, -value / self.value)


def jet_sqrt(x: Jet) -> Jet:
    """Return the square root, on the right half plane."""
    value = np.sqrt(x.value)
    return x.through(value, 0.5 / value)


def jet_exp(x: Jet) -> Jet:
    """Return the exponential."""
    value = np.exp(x.value)
    return x.through(value, value)


def jet_log(x: Jet) -> Jet:
    """Return the natural logarithm."""
    return x.through(np.log(x.value), 1 / x.value)


def jet_sin(x: Jet) -> Jet:
    """Return the sine."""
    return x.through(np.sin(x.value), np.cos(x.value))


def jet_cos(x: Jet) -> Jet:
    """Return the cosine."""
    return x.through(np.cos(x.value), -np.sin(x.value))


def jet_stack(jets: Sequence[Jet], axis: int) -> Jet:
    """Return jets beside each other, along a new leading axis."""
    values = np.broadcast_arrays(*(jet.value for jet in jets))
    slopes = np.broadcast_arrays(*(jet.slope for jet in jets))
    return Jet(np.stack(values, axis=axis), np.stack(slopes, axis=axis))


def jet_where(chosen: NDArray[np.bool_], one: Jet, other: Jet) -> Jet:
    """Return one jet where chosen, the other elsewhere."""
    value = np.where(chosen, one.value, other.value)
    return Jet(value, np.where(chosen[..., None], one.slope, other.slope))
