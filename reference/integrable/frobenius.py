"""Precession and spin as functions of nutation: the convergent series at the flat state.

With S = sin phi, T = tan(phi/2), spin s = Psi + Theta and b = S^2 Psi, the closed subsystem
(eq01:closed_subsystem) reads

    db/dphi = k c_p S s - (k c_p T + h k) b
    ds/dphi = (k c_p T + h k) s + M b,
    M = T' [(1 + T^2)/T - k c_p T - 2 h k - k a_p/T],   T' = (1 + T^2)/2.

Its only singular point short of phi = pi is phi = 0, a pole of M with residue L = 1 - k a_p. So
there is one regular solution (b1, s1) = (0, 1) + ..., and one with a logarithm,

    (b2, s2) = (1, 0) + ... + L log(phi) (b1, s1),

all four series converging for |phi| < pi. The matrix is traceless, so b2 s1 - b1 s2 = 1 for every
phi, and

    B = b s1 - s b1,      K = s b2 - b s2

are first integrals, without approximation. In the paper's terms (eq01:Psi0, eq0:Psi2, with q_2 = 0)
B is B_{-2}, and B_0 = k c_p K/2 + (the phi^2 coefficient of b2 plus 1/3) B.

The series of the paper are these, divided by S^2; its eq01:psi_orig and eq01:theta_orig carry
misprints (see `reference.asymptotic.expansions`).
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from reference.problem.can import Parameters
from reference.problem.states import Floats

# At phi = pi/2 the terms fall like 2^-n, times a low power of n from the double pole at pi.
MOST_TERMS = 72
# Places of one polynomial up to which all its powers fit in a processor's cache, and a product with
# them is too small for a library of linear algebra to share it among threads, on whose number the
# last bits would depend.
FEW = 120


@dataclass(frozen=True, slots=True, kw_only=True)
class CanConstants:
    """The constants of one can, or of n cans, as arrays of shape () or (n,)."""

    a: Floats
    c: Floats
    h: Floats

    @property
    def a_p(self) -> Floats:
        """Transverse moment about the contact, a + h^2."""
        return self.a + self.h**2

    @property
    def c_p(self) -> Floats:
        """Axial moment about the contact, c + 1."""
        return self.c + 1

    @property
    def k(self) -> Floats:
        """The constant c/(a + c a_p)."""
        return self.c / (self.a + self.c * self.a_p)

    @property
    def residue(self) -> Floats:
        """1 - k a_p = k a/c, the strength of the logarithm; positive."""
        return self.a / (self.a + self.c * self.a_p)


def can_constants(parameters: Parameters) -> CanConstants:
    """Return one can as arrays of shape ()."""
    return CanConstants(
        a=np.asarray(parameters.a), c=np.asarray(parameters.c), h=np.asarray(parameters.h)
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Series:
    """Coefficients in powers of phi, shape (terms,) or (terms, n).

    `b1`, `s1` regular; `b2`, `s2` the part of the second solution that has no logarithm.
    """

    b1: Floats
    s1: Floats
    b2: Floats
    s2: Floats


@lru_cache(maxsize=8)
def trigonometric_series(terms: int) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats]:
    """Return the power series that do not depend on the can.

    Returns
    -------
    S, T, T', T T', phi T'/T, 2 phi T'^2/T : ndarray, shape (terms,)
        With T = tan(phi/2); the last two are what is left of 1/S and (1 + T^2)^2/(2 T).
    """
    sine, tangent = np.zeros(terms + 1), np.zeros(terms + 1)
    slope = np.zeros(terms + 1)
    factorial = 1.0
    for n in range(1, terms + 1):
        factorial *= n
        sine[n] = (0.0, 1.0, 0.0, -1.0)[n % 4] / factorial
        # T' = (1 + T^2)/2: all terms positive, nothing cancels
        slope[n - 1] = (float(n == 1) + tangent[:n] @ tangent[n - 1 :: -1][:n]) / 2
        tangent[n] = slope[n - 1] / n
    product = np.convolve(tangent, slope)[:terms]
    square = np.convolve(slope[:terms], slope[:terms])[:terms]
    over = tangent[1 : terms + 1]
    cosecant, quartic = np.zeros(terms), np.zeros(terms)
    for n in range(terms):
        cosecant[n] = (slope[n] - over[1 : n + 1] @ cosecant[:n][::-1]) / over[0]
        quartic[n] = (2 * square[n] - over[1 : n + 1] @ quartic[:n][::-1]) / over[0]
    return sine[:terms], tangent[:terms], slope[:terms], product, cosecant, quartic


def frobenius_series(can: CanConstants, terms: int = MOST_TERMS) -> Series:
    """Coefficients of the two solutions, by recurrence.

    Parameters
    ----------
    can : Can
        One can or n cans.
    terms : int
        Number of powers.

    Returns
    -------
    Series
    """
    sine, tangent, slope, product, cosecant, quartic = trigonometric_series(terms)
    k, L = can.k, can.residue
    kc, hk, ka = k * can.c_p, can.h * k, k * can.a_p
    shape = (terms, *np.shape(k))
    # complex where the can is: a derivative by an imaginary step (`reference.integrable.tangents`)
    b1, s1, b2, s2 = (np.zeros(shape, dtype=np.asarray(k).dtype) for _ in range(4))
    s1[0] = 1.0
    b2[0] = 1.0
    for n in range(1, terms):
        for b, s, log_b, log_s in ((b1, s1, None, None), (b2, s2, b1, s1)):
            back = slice(n - 1, None, -1)
            head_b, head_s = b[:n], s[:n]
            b[n] = kc * _sum(sine[back], head_s) - kc * _sum(tangent[back], head_b) - hk * b[n - 1]
            if log_b is not None:
                b[n] -= L * log_b[n]
            b[n] /= n
            full = b[: n + 1]
            down = slice(n, None, -1)
            s[n] = (
                kc * _sum(tangent[back], head_s)
                + hk * s[n - 1]
                + _sum(quartic[down], full)
                - ka * _sum(cosecant[down], full)
                - kc * _sum(product[back], head_b)
                - 2 * hk * _sum(slope[back], head_b)
            )
            if log_s is not None:
                s[n] -= L * log_s[n]
            s[n] /= n
    return Series(b1=b1, s1=s1, b2=b2, s2=s2)


def _sum(weights: Floats, terms: Floats) -> Floats:
    """Weighted sum of terms, of many cans in an order that no number of threads decides."""
    if terms.ndim == 1:
        return np.asarray(weights @ terms)
    return np.asarray(np.einsum("k,kn->n", weights, terms))


@lru_cache(maxsize=64)
def series_of(parameters: Parameters) -> Series:
    """Return all terms for one can, shape (terms, 1), cached: a can is solved more than once."""
    return lift(frobenius_series(can_constants(parameters)))


def lift(series: Series) -> Series:
    """Give the series of one can a last axis of length 1."""
    return Series(
        b1=series.b1[:, None], s1=series.s1[:, None], b2=series.b2[:, None], s2=series.s2[:, None]
    )


def terms_needed(phi: float) -> int:
    """Terms that leave a remainder below round-off at nutation `phi`.

    The n-th term falls like (phi/pi)^n times a low power of n; 40 is -log of 4e-18.
    """
    return int(min(MOST_TERMS, 6 + 40.0 / np.log(np.pi / phi)))


def horner(coefficients: Floats, x: Floats) -> Floats:
    """Value of polynomials, coefficients of shape (terms, ...) broadcast against x."""
    return evaluated((coefficients,), x)[0]


def evaluated(polynomials: tuple[Floats, ...], x: Floats) -> list[Floats]:
    """Values of several polynomials at the same places, as by `horner`.

    Single polynomials at a few places are sums of terms, which are one product of two arrays.
    """
    if 0 < x.size <= FEW and all(each[0].size == 1 for each in polynomials):
        terms = max(len(each) for each in polynomials)
        rows = np.zeros((len(polynomials), terms))
        for row, each in zip(rows, polynomials, strict=True):
            row[: len(each)] = each.ravel()
        powers = np.empty((terms, x.size))
        powers[0] = 1.0
        powers[1:] = x.ravel()
        np.multiply.accumulate(powers, axis=0, out=powers)
        # a scalar place is one of the polynomial's own shape
        shape = x.shape or polynomials[0].shape[1:]
        return [np.asarray(value.reshape(shape)) for value in rows @ powers]
    return [_horner(each, x) for each in polynomials]


def _horner(coefficients: Floats, x: Floats) -> Floats:
    value = np.asarray(coefficients[-1] * x)
    value += coefficients[-2]
    for row in coefficients[-3::-1]:
        value *= x
        value += row
    return value


def first_integrals(
    can: CanConstants, series: Series, phi: Floats, psi_dot: Floats, spin: Floats
) -> tuple[Floats, Floats]:
    """Return the constants (K, B) of a state.

    Parameters
    ----------
    can, series : Can, Series
    phi, psi_dot, spin : ndarray, shape (n,)
        Nutation, precession rate and psi' + theta'.

    Returns
    -------
    K, B : ndarray, shape (n,)
        B is the paper's B_{-2}; K is the spin that would be left at phi = 1 rad of logarithm.
    """
    b = np.sin(phi) ** 2 * psi_dot
    b1, s1 = horner(series.b1, phi), horner(series.s1, phi)
    log = can.residue * np.log(phi)
    b2 = horner(series.b2, phi) + log * b1
    s2 = horner(series.s2, phi) + log * s1
    return spin * b2 - b * s2, b * s1 - spin * b1


def precession_and_spin(
    can: CanConstants, series: Series, phi: Floats, K: Floats, B: Floats
) -> tuple[Floats, Floats]:
    """Return Psi and s = Psi + Theta at nutation `phi` on the branch (K, B), shape (n,)."""
    log = K + B * can.residue * np.log(phi)
    b = log * horner(series.b1, phi) + B * horner(series.b2, phi)
    s = log * horner(series.s1, phi) + B * horner(series.s2, phi)
    return b / np.sin(phi) ** 2, s
