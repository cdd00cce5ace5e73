"""The potential well in which nutation moves, free of cancellation.

With the first integrals fixed, energy leaves (a_p + 1) phi'^2/2 = g(phi) with

    g(phi) = E - V(phi),    V = (a q^2 + c w^2 + (w - h q)^2)/2 + S + h C,
    q = b/S,    w = s - b/(1 + C)        (b, s of `reference.integrable.frobenius`).

Near a turning point and near the balancing angle g is a small difference of large terms. So every
quantity is carried as its difference from its value at a reference nutation r, which for a release
at rest is the release itself: polynomials through their exact divided differences, the logarithm as
log1p, gravity as

    (S_r - S) + h (C_r - C) = 2 sqrt(1 + h^2) sin((r - phi)/2) sin(phi* - r + (r - phi)/2),

with phi* - r exact for the doubles given (`reference.equations.balancing_angle`). Beside an
equilibrium even the
first order of the kinetic energy cancels: there it is the mean of its force, in which that order
is a factor. Of a small oscillation about one even the force cancels, and g between its two roots is
that of the mean of its second derivative (`between`).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import roots_jacobi

from reference.equations.balancing_angle import short_of_balance
from reference.integrable.frobenius import CanConstants, Series, evaluated, horner
from reference.problem.states import Floats

NEARLY_ALL = 0.75
# A release is poised where the whole force on it is less than this share of its kinetic energy:
# of a force computed from differences of that energy three digits would be lost.
POISED = 1e-3
# Down to here the mean force is taken, over this share of the reference nutation; the singularity
# at phi = 0 is so far that Gauss's rule with six nodes is exact to (0.05/4)^12.
BESIDE = 0.05
# Rounded operations that count in a difference of energies, of the size of its terms: at 900 random
# places the worst takes 0.94 of the bound, or 0.86 with the sines of another processor.
UNCERTAIN = 2.8
GAUSS_NODES, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(6)
# For means with the weight 2 u over [0, 1]: on as short a way four nodes are exact to (0.05/4)^8.
HAT_NODES, HAT_WEIGHTS = roots_jacobi(4, 0, 1)


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectivePotential:
    """The wells of n releases; every field has shape (n,) or (terms, n).

    Attributes
    ----------
    can : Can
    series : Series
        Of the one can, shape (terms, 1), or of n cans, shape (terms, n).
    reference : ndarray
        Nutation r.
    short : ndarray
        phi* - r, to relative round-off.
    b, spin, excess : ndarray
        b, s and g there.
    B : ndarray
        First integral.
    part_b : ndarray, shape (terms, n)
        The part of b that has no log(phi/r).
    quotient_b, quotient_s : ndarray, shape (terms - 1, n)
        Divided differences at r of that part, and of the same part of s.
    poised : ndarray of bool
        Where the force on phi at r nearly vanishes.
    """

    can: CanConstants
    series: Series
    reference: Floats
    short: Floats
    b: Floats
    spin: Floats
    excess: Floats
    B: Floats
    part_b: Floats
    quotient_b: Floats
    quotient_s: Floats
    poised: NDArray[np.bool_]


def effective_potential(
    can: CanConstants,
    series: Series,
    *,
    phi: Floats,
    b: Floats,
    spin: Floats,
    excess: Floats,
    B: Floats | None = None,
    short: Floats | None = None,
) -> EffectivePotential:
    """Return the well that passes through (b, s, g) at nutation phi, all of shape (n,).

    The first integral B may be given where it is known better: of a can that moves near the flat
    state and rises far above it, B is a small difference of what b and s are up there. So may the
    distance `short` from balance, where phi is the rounded value of what is meant.
    """
    if B is None:
        B = b * horner(series.s1, phi) - spin * horner(series.b1, phi)
    # the constant that multiplies (b1, s1) when the logarithm is that of phi/r
    K = spin * horner(series.b2, phi) - b * horner(series.s2, phi)
    part_b = K * series.b1 + B * series.b2
    short = short_of_balance(can.h, phi) if short is None else short
    force = _kinetic_force(can, b, spin, phi) - np.sqrt(1 + can.h**2) * np.sin(short)
    return EffectivePotential(
        can=can,
        series=series,
        reference=phi,
        short=short,
        b=b,
        spin=spin,
        excess=excess,
        B=B,
        part_b=part_b,
        quotient_b=_quotient(part_b, phi),
        quotient_s=_quotient(K * series.s1 + B * series.s2, phi),
        poised=np.abs(force) < POISED * (spin**2 + (b / np.sin(phi)) ** 2),
    )


def select_potential(well: EffectivePotential, index: NDArray[np.intp]) -> EffectivePotential:
    """Return some of the wells."""
    can, series = well.can, well.series
    if can.a.size > 1:
        can = CanConstants(a=can.a[index], c=can.c[index], h=can.h[index])
        series = Series(
            b1=series.b1[:, index],
            s1=series.s1[:, index],
            b2=series.b2[:, index],
            s2=series.s2[:, index],
        )
    return EffectivePotential(
        can=can,
        series=series,
        reference=well.reference[index],
        short=well.short[index],
        b=well.b[index],
        spin=well.spin[index],
        excess=well.excess[index],
        B=well.B[index],
        part_b=well.part_b[:, index],
        quotient_b=well.quotient_b[:, index],
        quotient_s=well.quotient_s[:, index],
        poised=well.poised[index],
    )


def _quotient(coefficients: Floats, at: Floats) -> Floats:
    """Coefficients of (p(x) - p(at))/(x - at), by synthetic division."""
    out = np.empty((coefficients.shape[0] - 1, at.size))
    carry = np.broadcast_to(coefficients[-1], at.shape)
    for n in range(out.shape[0] - 1, -1, -1):
        out[n] = carry
        carry = coefficients[n] + at * carry
    return out


@dataclass(frozen=True, slots=True, kw_only=True)
class PotentialState:
    """Quantities at nutations of shape (m, n): b, the spin, sin phi, and g/(r - phi)."""

    b: Floats
    spin: Floats
    sine: Floats
    slope: Floats


def evaluate_potential(well: EffectivePotential, phi: Floats, below: Floats) -> PotentialState:
    """Return the state at nutation `phi`, a distance `below` = r - phi under the reference.

    Parameters
    ----------
    well : EffectivePotential
        With `excess` zero, for the slope to be finite at the reference.
    phi, below : ndarray, shape (m, n)
        Each to its own relative round-off; `slope is given as 0 where `below` is.

    Returns
    -------
    Level
    """
    can, r, b_r, s_r = well.can, well.reference, well.b, well.spin
    # log1p near the reference, the logarithm itself where little of the nutation is left
    share = below / r
    deep = share > NEARLY_ALL
    log = np.where(deep, np.log(phi / r), np.log1p(-np.minimum(share, NEARLY_ALL)))
    log *= well.B * can.residue
    b1, s1, quotient_b, quotient_s, part_b = evaluated(
        (well.series.b1, well.series.s1, well.quotient_b, well.quotient_s, well.part_b), phi
    )
    log_b = log * b1
    db = log_b - below * quotient_b
    # deep down b is the first integral and little else: there its own series, not a difference
    b = np.where(deep, log_b + part_b, b_r + db)
    db = np.where(deep, b - b_r, db)
    ds = log * s1 - below * quotient_s
    S_r, C_r, S = np.sin(r), np.cos(r), np.sin(phi)
    half = np.sin(below / 2)
    # chords of the circle, turned by half the way: no difference of near numbers
    other = np.sqrt(1 - half**2)
    dS = -2 * half * (C_r * other + S_r * half)
    dC = 2 * half * (S_r * other - C_r * half)
    C = C_r + dC
    q_r, tilt_r = b_r / S_r, b_r / (1 + C_r)
    dq = np.where(deep, b / S - q_r, (db * S_r - b_r * dS) / (S * S_r))
    dw = ds - (db * (1 + C_r) - b_r * dC) / ((1 + C) * (1 + C_r))
    w_r = s_r - tilt_r
    v_r = w_r - can.h * q_r
    dv = dw - can.h * dq
    kinetic = (can.a * dq * (2 * q_r + dq) + can.c * dw * (2 * w_r + dw) + dv * (2 * v_r + dv)) / 2
    poised = np.flatnonzero(well.poised)
    if poised.size:
        kinetic[:, poised] = _by_mean_force(well, kinetic, below, poised)
    lean = 2 * half * np.sqrt(1 + can.h**2) * np.sin(well.short + below / 2)
    drop = well.excess + lean - kinetic
    slope = np.divide(drop, below, out=np.zeros_like(drop), where=below != 0)
    return PotentialState(b=b, spin=s_r + ds, sine=S, slope=slope)


def energy_noise(
    well: EffectivePotential, phi: Floats, below: Floats, state: PotentialState
) -> Floats:
    """Round-off of g, shape (m, n): what may be wrong with it for the doubles given.

    Parameters
    ----------
    well : EffectivePotential
    phi, below : ndarray, shape (m, n)
    state : PotentialState
        There.
    """
    can, r = well.can, well.reference
    apart = np.abs(below)
    sums = np.zeros_like(phi)
    b_size = np.abs(well.b) + np.abs(well.spin) * np.minimum(r, phi) * r
    s_size = np.abs(well.spin) + np.abs(well.b) * (1 + np.abs(np.log(phi / r)))
    for at, b, s in ((phi, state.b, state.spin), (r, well.b, well.spin)):
        S, C = np.sin(at), np.cos(at)
        q, w = np.abs(b) / S, np.abs(s) + np.abs(b) / (1 + C)
        dq = (np.abs(b) + b_size) / S
        dw = w + s_size + b_size
        sums = sums + can.a * q * dq + can.c * w * dw + (w + can.h * q) * (dw + can.h * dq)
    lean = np.sqrt(1 + can.h**2) * np.abs(well.short + below / 2)
    # differences from the reference vanish with the distance from it, and their round-off too
    sums = sums * np.minimum(1.0, apart / phi) + lean * apart + well.excess
    return np.asarray(UNCERTAIN * np.finfo(float).eps * sums)


def between(well: EffectivePotential, rise: Floats, gap: Floats) -> tuple[Floats, Floats]:
    """Return g/(rise gap) between two roots of g, and its round-off, each of shape (m, n).

    With two roots this is minus the second divided difference of g, which is half the mean of g''
    weighted by a hat: zero at the roots, and highest at the nutation asked for.

    Parameters
    ----------
    well : EffectivePotential
        Referred to the upper root.
    rise, gap : ndarray, shape (m, n)
        Distances from the lower root, and from the upper one.
    """
    total, size = np.zeros_like(gap), np.zeros_like(gap)
    swing = rise + gap
    for node, weight in zip((HAT_NODES + 1) / 2, HAT_WEIGHTS / 2, strict=True):
        for down, share in ((swing - node * rise, rise / swing), (node * gap, gap / swing)):
            bend, terms = _force_slope(well, down)
            total -= weight * share * bend / 2
            size += weight * share * terms / 2
    return total, UNCERTAIN * np.finfo(float).eps * size


def energy_near_reference(
    well: EffectivePotential, down: Floats
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return g, its round-off, b and the spin a little below the reference, each of shape (m, n).

    By Taylor's theorem, g = g_r - g'_r d + d^2 times the integral of (1 - u) g''(r - u d) over u.
    The force g'_r is one number for all places: its round-off shifts a barrier by a rounding of
    phi, and changes the energy left there as that rounding would. The round-off returned is that of
    the other terms, which differs from place to place.

    Parameters
    ----------
    well : EffectivePotential
    down : ndarray, shape (m, n)
        Distance below the reference, of either sign, at most `BESIDE` of the reference.
    """
    bends, sizes = np.zeros_like(down), np.zeros_like(down)
    for node, weight in zip((HAT_NODES + 1) / 2, HAT_WEIGHTS / 2, strict=True):
        bend, terms = _force_slope(well, (1 - node) * down)
        bends += weight * bend / 2
        sizes += weight * terms / 2
    force = nutation_force(well.can, well.b, well.spin, well.reference)
    g = well.excess - force * down + bends * down**2
    noise = UNCERTAIN * np.finfo(float).eps * sizes * down**2
    return g, noise, *_beside(well, well.reference - down, down)


def _force_slope(well: EffectivePotential, down: Floats) -> tuple[Floats, Floats]:
    """Return the second derivative of g a little below the reference, and the size of its terms."""
    can, phi = well.can, well.reference - down
    b, s = _beside(well, phi, down)
    S, C = np.sin(phi), np.cos(phi)
    T = S / (1 + C)
    slope = 1 / (1 + C)
    kc, hk = can.k * can.c_p, can.h * can.k
    # the equations of b and s (`reference.frobenius`)
    b_slope = kc * S * s - (kc * T + hk) * b
    M = slope * (2 * slope / T - kc * T - 2 * hk - can.k * can.a_p / T)
    s_slope = (kc * T + hk) * s + M * b
    square = can.a_p * C + can.c_p * T * S + can.h * T * (1 + 2 * C)
    square_slope = (can.c_p - can.a_p) * S + can.h * (slope * (1 + 2 * C) - 2 * T * S)
    drag, drag_slope = can.c_p * S + can.h * C, can.c_p * C - can.h * S
    terms = (
        2 * b * b_slope * square / S**3,
        b**2 * square_slope / S**3,
        -3 * b**2 * square * C / S**4,
        -(drag_slope * b * s + drag * (b_slope * s + b * s_slope)) / S**2,
        2 * drag * b * s * C / S**3,
        can.h * C + S,
    )
    return np.sum(terms, axis=0), np.sum(np.abs(terms), axis=0)


def _beside(well: EffectivePotential, phi: Floats, down: Floats) -> tuple[Floats, Floats]:
    """Return b and the spin at nutations a little below the reference, shape (m, n)."""
    log = np.log1p(-down / well.reference) * well.B * well.can.residue
    b1, s1, quotient_b, quotient_s = evaluated(
        (well.series.b1, well.series.s1, well.quotient_b, well.quotient_s), phi
    )
    return well.b + log * b1 - down * quotient_b, well.spin + log * s1 - down * quotient_s


def _by_mean_force(
    well: EffectivePotential, kinetic: Floats, below: Floats, poised: NDArray[np.intp]
) -> Floats:
    """Kinetic energy over that at the reference of some wells, by its mean force beside it."""
    some = select_potential(well, poised)
    known = kinetic[:, poised]
    fall = np.broadcast_to(below, kinetic.shape)[:, poised]
    beside = np.abs(fall) < BESIDE * some.reference
    reach = np.where(beside, fall, 0.0)
    share = (GAUSS_NODES[:, None, None] + 1) / 2
    down = (share * reach).reshape(-1, reach.shape[1])
    phi = some.reference - down
    force = _kinetic_force(some.can, *_beside(some, phi, down), phi)
    mean = np.einsum("k,kmn->mn", GAUSS_WEIGHTS / 2, force.reshape(-1, *reach.shape))
    return np.asarray(np.where(beside, reach * mean, known))


def nutation_force(can: CanConstants, b: Floats, spin: Floats, phi: Floats) -> Floats:
    """Return dg/dphi = (a_p + 1) phi'', from eq01:Phi, shape of `phi`."""
    return np.asarray(_kinetic_force(can, b, spin, phi) + can.h * np.sin(phi) - np.cos(phi))


def _kinetic_force(can: CanConstants, b: Floats, spin: Floats, phi: Floats) -> Floats:
    """Return the part of dg/dphi that is not gravity: minus the slope of the kinetic energy."""
    S, C = np.sin(phi), np.cos(phi)
    T = S / (1 + C)
    q = b / S
    square = can.a_p * C + can.c_p * T * S + can.h * T * (1 + 2 * C)
    return np.asarray(q * (q * square - (can.c_p * S + can.h * C) * spin) / S)
