"""The forms that the audit finds right are those that `reference` derives and uses by itself."""

import math

import mpmath as mp
import numpy as np
import pytest
import sympy as sp

from harness.paper import release
from harness.paper.audit import flat_motion, paper_can
from harness.paper.audit.checks import reduced, steady_motions
from harness.paper.audit.checks.outer import RIGHT_FORMS, time
from harness.paper.audit.flat_series import c_p, h, in_inertias, k
from harness.paper.audit.symbols import B0, B2
from harness.paper.audit.symbols import a as sym_a
from harness.paper.audit.symbols import c as sym_c
from harness.paper.audit.symbols import h as sym_h
from harness.paper.audit.symbols import phi as sym_phi
from reference import PAPER_CAN
from reference.asymptotic.expansions import paper_constants
from reference.asymptotic.matched import integrals
from reference.asymptotic.small_nutation import NAMES, reduced_equation
from reference.equations.steady_motion import critical_rolling_rate, rest_rates
from reference.problem.states import initial_states

EPS = float(np.finfo(float).eps)
CAN = {sym_a: PAPER_CAN.a, sym_c: PAPER_CAN.c, sym_h: PAPER_CAN.h}
RELEASE = release.problem(bounces=1)


def test_the_critical_rate() -> None:
    stiffness = float(steady_motions.STIFFNESS.subs(CAN))
    square = math.hypot(1, PAPER_CAN.h) / stiffness
    assert critical_rolling_rate(PAPER_CAN) == pytest.approx(math.sqrt(square), rel=8 * EPS)


@pytest.mark.parametrize("degrees", [5, 20, 33])
def test_the_rates_at_rest(degrees: float) -> None:
    angle = math.radians(degrees)
    square = float(steady_motions._rest_square(-1).subs(CAN | {sym_phi: angle}))  # noqa: SLF001
    psi, theta = rest_rates(PAPER_CAN, angle)
    assert psi**2 == pytest.approx(square, rel=1e3 * EPS)  # the numerator cancels towards phi*
    side = math.cos(angle) - PAPER_CAN.h * math.sin(angle)
    assert theta == pytest.approx(-psi * side, rel=1e3 * EPS)


def test_the_constants_of_the_release() -> None:
    ours = [float(x) for x in flat_motion.exact_constants()]
    theirs = [float(x[0]) for x in paper_constants(initial_states(RELEASE), PAPER_CAN)]
    # Psi + Theta is a thousandth of either: three digits fewer
    assert ours == pytest.approx(theirs, rel=1e4 * EPS)


@pytest.mark.slow
def test_the_coefficients_of_the_reduced_equation() -> None:
    zero, two = 0.4, 1.0
    theirs = reduced_equation(PAPER_CAN, zero, two)
    values = CAN | {B0: zero, B2: two}
    for name in NAMES:
        ours = float(in_inertias(reduced.derived(name.removeprefix("a_"))).subs(values))
        # sums of a dozen terms of order one
        assert getattr(theirs, name) == pytest.approx(ours, rel=1e4 * EPS, abs=100 * EPS), name


def test_the_motion_at_small_nutation_solves_the_closed_subsystem() -> None:
    """Differentiate Theta, which `flat_motion` does not."""
    p = paper_can
    with mp.workdps(40):
        x = mp.mpf("0.004")
        psi, theta = flat_motion.rates(x, mp.mpf("0.7"), mp.mpf(1))
        slope = mp.diff(lambda y: flat_motion.rates(y, mp.mpf("0.7"), mp.mpf(1))[1], x)
        sine, cosine = mp.sin(x), mp.cos(x)
        right = (-p.k * p.c_p * cosine + p.h * p.k * sine) * theta
        square = p.k * p.c_p * cosine**2 + p.k * p.a_p * sine**2
        right += (2 + p.h * p.k * mp.sin(2 * x) - square) * psi
        # half the digits are lost to the numerical derivative
        assert abs(slope * sine - right) < mp.mpf("1e-15") * abs(right)


def test_the_double_integrals() -> None:
    at = np.array([0.3, 0.8])
    theirs = integrals(at)
    for name, form in RIGHT_FORMS.items():
        if name not in theirs:
            continue
        right = sp.lambdify(time, form, "mpmath")
        for place, value in zip(at, theirs[name], strict=True):
            ours = float(mp.re(right(mp.mpf(float(place)))))
            assert value == pytest.approx(ours, rel=1e-11), name


def test_the_letters_are_those_of_the_can() -> None:
    values = [float(in_inertias(letter).subs(CAN)) for letter in (k, h, c_p)]
    assert values == pytest.approx([PAPER_CAN.k, PAPER_CAN.h, PAPER_CAN.c_p], rel=8 * EPS)
