"""Jets against imaginary steps, real and complex."""

import numpy as np
import pytest

from reference.numerics.jets import Jet, jet_cos, jet_sin, jet_sqrt, jet_where

STEP = 1e-30


def formula(x: Jet, y: Jet) -> Jet:
    ratio = (2.0 - jet_sin(x) * y) / (1.0 + x * x)
    return jet_sqrt(3.0 / ratio + jet_cos(y) * 0.5) - x / 4.0


def test_derivatives_of_a_formula_are_those_of_imaginary_steps() -> None:
    point = np.array([0.3, 0.7])
    x, y = (Jet(np.array(value), unit) for value, unit in zip(point, np.eye(2), strict=True))
    own = formula(x, y)
    none = np.zeros(2)
    for place in range(2):
        stepped = point + 1j * STEP * np.eye(2)[place]
        value = formula(*(Jet(np.asarray(each), none) for each in stepped)).value
        assert own.slope[place] == pytest.approx(value.imag / STEP, rel=1e-14)
        assert own.value == pytest.approx(value.real, rel=1e-15)


def test_leading_axes_broadcast_and_stay_before_the_derivatives() -> None:
    x = Jet(np.arange(1.0, 4.0), np.eye(3))
    grid = np.array([[0.5], [2.0j]])
    product = x * grid
    assert product.value.shape == (2, 3)
    assert product.slope.shape == (2, 3, 3)
    assert np.array_equal(product.slope[1], 2.0j * np.eye(3))
    chosen = jet_where(np.array([True, False, True]), x, -x)
    assert chosen.value.tolist() == [1.0, -2.0, 3.0]
    assert np.diag(chosen.slope).tolist() == [1.0, -1.0, 1.0]
