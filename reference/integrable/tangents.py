"""The potential well of the nutation with its derivatives by the release and the can.

g(phi) of `reference.integrable.effective_potential`, in the same differences from the release that
lose no digits, in jets (`reference.numerics.jets`): at a fixed nutation, real or complex, with the
derivatives of g, b and the spin by the release (phi, phi', psi', theta'), by the can (a, c, h), and
by the nutation itself. The coefficients of the Frobenius series are analytic in the can, and their
derivatives come of imaginary steps, Im f(a + i s)/s (Squire and Trapp, SIAM Review 40, 1998).
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from reference.equations.balancing_angle import short_of_balance
from reference.integrable.effective_potential import (
    BESIDE,
    GAUSS_NODES,
    GAUSS_WEIGHTS,
    NEARLY_ALL,
    POISED,
)
from reference.integrable.frobenius import CanConstants, frobenius_series
from reference.numerics.jets import Jet, Values, jet_cos, jet_sin, jet_sqrt, jet_stack, jet_where
from reference.problem.states import Floats

BY = ("phi", "phi_dot", "psi_dot", "theta_dot", "a", "c", "h")
"""What derivatives are taken by, in order."""
AT = len(BY)
"""Place of the derivative by the nutation at which something is evaluated."""
# Nothing is subtracted along an imaginary step, so it is as small as may be.
STEP = 1e-40


@dataclass(frozen=True, slots=True, kw_only=True)
class TangentWell:
    """The wells of n releases in jets; every field has values of shape (n,), but for three.

    Attributes
    ----------
    a, c, h : Jet
    reference, short : Jet
        Nutation r of the release, and phi* - r.
    b, spin, excess : Jet
        b, s and g there.
    B, K : Jet
        First integrals: b = B (residue log(phi/r) b1 + b2) + K b1, and likewise the spin.
    series : Jet, shape (terms, 4, n)
        b1, s1, b2 and s2.
    polynomials : Jet, shape (terms, 5, n)
        b1, s1, the divided differences of b and s at r, and the part of b without a logarithm.
    poised : bool
        Whether for some release the force on phi at r nearly vanishes.
    """

    a: Jet
    c: Jet
    h: Jet
    reference: Jet
    short: Jet
    b: Jet
    spin: Jet
    excess: Jet
    B: Jet
    K: Jet
    series: Jet
    polynomials: Jet
    poised: bool

    @property
    def inertia(self) -> Jet:
        """Return the inertia of the nutation, a_p + 1."""
        return self.a + self.h * self.h + 1.0

    @property
    def residue(self) -> Jet:
        """Return the strength of the logarithm."""
        return self.a / (self.a + self.c * (self.a + self.h * self.h))


@dataclass(frozen=True, slots=True, kw_only=True)
class ClockNodes:
    """Nutations at nodes of the clock's time, shape (m, n), real or complex.

    Attributes
    ----------
    phi, below : ndarray
        Nutation, and its distance below that of the release.
    rise, gap : ndarray
        Its distances from phi_min and phi_max.
    """

    phi: Values
    rise: Values
    gap: Values
    below: Values


@dataclass(frozen=True, slots=True, kw_only=True)
class TangentState:
    """Jets at nutations of shape (m, n): the nutation, q = b/sin(phi), the spin, S, C and g."""

    phi: Jet
    q: Jet
    spin: Jet
    sine: Jet
    cosine: Jet
    g: Jet

    @property
    def psi_dot(self) -> Jet:
        """Return the precession rate."""
        return self.q / self.sine


def seeds(**numbers: Floats) -> dict[str, Jet]:
    """Return the independent numbers `BY` as jets, of shape (n,) each."""
    out = {}
    for place, name in enumerate(BY):
        slope = np.zeros((*np.shape(numbers[name]), AT + 1))
        slope[..., place] = 1.0
        out[name] = Jet(np.asarray(numbers[name], dtype=float), slope)
    return out


@lru_cache(maxsize=64)
def _series_of_one(a: float, c: float, h: float) -> Jet:
    return _series(np.array([a]), np.array([c]), np.array([h]))


def _series(a: Floats, c: Floats, h: Floats) -> Jet:
    """Return the coefficients of b1, s1, b2, s2 of n cans, shape (terms, 4, n)."""
    stepped = [np.tile(value.astype(complex), (3, 1)) for value in (a, c, h)]
    for place in range(3):
        stepped[place][place] += 1j * STEP
    cans = CanConstants(a=stepped[0].ravel(), c=stepped[1].ravel(), h=stepped[2].ravel())
    series = frobenius_series(cans)
    parts = np.stack([series.b1, series.s1, series.b2, series.s2], axis=1)
    parts = parts.reshape(*parts.shape[:2], 3, a.size)
    slope = np.zeros((*parts.shape[:2], a.size, AT + 1))
    slope[..., BY.index("a") : BY.index("h") + 1] = np.moveaxis(parts.imag / STEP, 2, -1)
    return Jet(parts[:, :, 0].real, slope)


def tangent_well(numbers: dict[str, Jet]) -> TangentWell:
    """Return the wells through releases.

    Parameters
    ----------
    numbers : dict of str to Jet, shape (n,)
        By the names `BY`.
    """
    r, psi_dot = numbers["phi"], numbers["psi_dot"]
    a, c, h = (numbers[name] for name in ("a", "c", "h"))
    cans = [part.value for part in (a, c, h)]
    if all((part == part[0]).all() for part in cans):
        series = _series_of_one(*(float(part[0]) for part in cans))
    else:
        series = _series(*cans)
    sine, spin = jet_sin(r), psi_dot + numbers["theta_dot"]
    b = sine * sine * psi_dot
    at_release = polynomial(series, Jet(r.value[None], r.slope[None]))
    b1, s1, b2, s2 = (at_release[place, 0] for place in range(4))
    B, K = b * s1 - spin * b1, spin * b2 - b * s2
    part_b = series[:, 0] * K + series[:, 2] * B
    part_s = series[:, 1] * K + series[:, 3] * B
    stack = [series[:, 0], series[:, 1], _quotient(part_b, r), _quotient(part_s, r), part_b]
    slope = -r.slope - h.slope / (1 + h.value**2)[..., None]
    short = Jet(short_of_balance(h.value, r.value), slope)
    inertia = a + h * h + 1.0
    well = TangentWell(
        a=a,
        c=c,
        h=h,
        reference=r,
        short=short,
        b=b,
        spin=spin,
        excess=inertia * numbers["phi_dot"] * numbers["phi_dot"] * 0.5,
        B=B,
        K=K,
        series=series,
        polynomials=jet_stack(stack, axis=1),
        poised=False,
    )
    force = _kinetic_force(well, b, spin, r) - jet_sqrt(1.0 + h * h) * jet_sin(short)
    size = spin.value**2 + (b.value / sine.value) ** 2
    return replace(well, poised=bool((np.abs(force.value) < POISED * size).any()))


def polynomial(coefficients: Jet, x: Jet) -> Jet:
    """Return polynomials at jets.

    Parameters
    ----------
    coefficients : Jet, shape (terms, p, n)
    x : Jet, shape (m, n)

    Returns
    -------
    Jet, shape (p, m, n)
    """
    value, slope = coefficients.value, coefficients.slope
    powers = np.empty((value.shape[0], *x.value.shape), dtype=x.value.dtype)
    powers[0] = 1.0
    powers[1:] = x.value
    np.multiply.accumulate(powers, axis=0, out=powers)
    rise = value[1:] * np.arange(1, value.shape[0])[:, None, None]
    # sums in one order, whatever the number of threads
    by_x = np.einsum("tpn,tmn->pmn", rise, powers[:-1])
    by_coefficients = np.einsum("tpnk,tmn->pmnk", slope, powers)
    return Jet(
        np.einsum("tpn,tmn->pmn", value, powers), by_coefficients + by_x[..., None] * x.slope
    )


def _quotient(coefficients: Jet, at: Jet) -> Jet:
    """Return the coefficients of (p(x) - p(at))/(x - at), and a zero: those of p are as many."""
    value, slope = np.zeros_like(coefficients.value), np.zeros_like(coefficients.slope)
    carry = coefficients[-1]
    for n in range(value.shape[0] - 2, -1, -1):
        value[n], slope[n] = carry.value, carry.slope
        carry = coefficients[n] + at * carry
    return Jet(value, slope)


def fixed(phi: Values) -> Jet:
    """Return nutations of shape (m, n) that depend on nothing but themselves."""
    slope = np.zeros(AT + 1)
    slope[AT] = 1.0
    return Jet(phi, np.broadcast_to(slope, (*phi.shape, AT + 1)))


def _log1p(z: Values) -> Values:
    """Return log(1 + z) to relative round-off: numpy's of complex numbers is to absolute."""
    if not np.iscomplexobj(z):
        return np.asarray(np.log1p(z))
    x, y = z.real, z.imag
    return np.asarray(np.log1p(x * (2 + x) + y * y) / 2 + 1j * np.arctan2(y, 1 + x))


def logarithm(well: TangentWell, phi: Jet, below: Jet) -> Jet:
    """Return the logarithm of nutations over those of the releases, from where it is known best."""
    share = below.value / well.reference.value
    deep = np.abs(share) > NEARLY_ALL
    log = np.where(
        deep,
        np.log(phi.value / well.reference.value),
        _log1p(-np.where(deep, 0.0, share)),
    )
    by = phi.slope / phi.value[..., None] - (well.reference.slope / well.reference.value[..., None])
    return Jet(log, by)


def _beside(well: TangentWell, phi: Jet, below: Jet) -> tuple[Jet, Jet, list[Jet]]:
    """Return the differences of b and of the spin from those at the reference, and the parts."""
    deep = np.abs(below.value / well.reference.value) > NEARLY_ALL
    log = logarithm(well, phi, below) * well.B * well.residue
    stack = polynomial(well.polynomials, phi)
    b1, s1, quotient_b, quotient_s, part_b = (stack[place] for place in range(5))
    db = log * b1 - below * quotient_b
    db = jet_where(deep, log * b1 + part_b - well.b, db)
    return db, log * s1 - below * quotient_s, [log * b1, part_b]


def tangent_state(well: TangentWell, phi: Values, below: Values) -> TangentState:
    """Return jets at nutations.

    Parameters
    ----------
    well : TangentWell
    phi, below : ndarray, shape (m, n), real or complex
        Nutation, and its distance under that of the release, each to its own relative round-off.
    """
    at = fixed(phi)
    gap = Jet(below, well.reference.slope - at.slope)
    db, ds, (log_b, part_b) = _beside(well, at, gap)
    deep = np.abs(below / well.reference.value) > NEARLY_ALL
    b, spin = jet_where(deep, log_b + part_b, well.b + db), well.spin + ds
    S_r, C_r = jet_sin(well.reference), jet_cos(well.reference)
    S = jet_sin(at)
    half, other = jet_sin(gap * 0.5), jet_cos(gap * 0.5)
    dS = half * (C_r * other + S_r * half) * -2.0
    dC = half * (S_r * other - C_r * half) * 2.0
    C = C_r + dC
    q_r, w_r = well.b / S_r, well.spin - well.b / (1.0 + C_r)
    dq = jet_where(deep, b / S - q_r, (db * S_r - well.b * dS) / (S * S_r))
    dw = ds - (db * (1.0 + C_r) - well.b * dC) / ((1.0 + C) * (1.0 + C_r))
    v_r, dv = w_r - well.h * q_r, dw - well.h * dq
    kinetic = 0.5 * (
        well.a * dq * (2.0 * q_r + dq) + well.c * dw * (2.0 * w_r + dw) + dv * (2.0 * v_r + dv)
    )
    if well.poised:
        near = np.abs(below) < BESIDE * well.reference.value
        kinetic = jet_where(near, _by_mean_force(well, gap), kinetic)
    lean = 2.0 * half * jet_sqrt(1.0 + well.h * well.h) * jet_sin(well.short + gap * 0.5)
    g = well.excess + lean - kinetic
    return TangentState(phi=at, q=q_r + dq, spin=spin, sine=S, cosine=C, g=g)


def _by_mean_force(well: TangentWell, below: Jet) -> Jet:
    """Return the kinetic energy over that at the reference by its mean force on the way there."""
    total = below * 0.0
    for node, weight in zip((GAUSS_NODES + 1) / 2, GAUSS_WEIGHTS / 2, strict=True):
        down = below * node
        place = well.reference - down
        db, ds, _ = _beside(well, place, down)
        total = total + _kinetic_force(well, well.b + db, well.spin + ds, place) * weight
    return total * below


def kinetic_energy(well: TangentWell, q: Jet, w: Jet) -> Jet:
    """Return the kinetic energy of turning about the contact, of b/sin(phi) and s - b/(1 + C)."""
    v = w - well.h * q
    return 0.5 * (well.a * q * q + well.c * w * w + v * v)


def _kinetic_force(well: TangentWell, b: Jet, spin: Jet, phi: Jet) -> Jet:
    """Return the part of dg/dphi that is not gravity."""
    S = jet_sin(phi)
    return _force_times_sine(well, b / S, spin, S, jet_cos(phi)) / S


def _force_times_sine(well: TangentWell, q: Jet, spin: Jet, S: Jet, C: Jet) -> Jet:
    """Return that part times sin(phi)."""
    T, h = S / (1.0 + C), well.h
    a_p, c_p = well.a + h * h, well.c + 1.0
    square = a_p * C + c_p * T * S + h * T * (1.0 + 2.0 * C)
    return q * (q * square - (c_p * S + h * C) * spin)


def force_ratio(well: TangentWell, state: TangentState) -> Jet:
    """Return |F|/N of rolling, with phi'^2 from g (`reference.equations.reaction_force`).

    From both times sin(phi), which are not large where phi is small. No number where N is not
    positive.
    """
    S, C, q, s, h = state.sine, state.cosine, state.q, state.spin, well.h
    T = S / (1.0 + C)
    phi_ddot = (_force_times_sine(well, q, s, S, C) + (h * S - C) * S) / well.inertia
    squared = 2.0 * state.g / well.inertia
    F_x = -(S + h * C) * phi_ddot - (C - h * S) * S * squared - q * (s - q * (T + h))
    k = well.c / (well.a + well.c * (well.a + h * h))
    across = k * (well.a * q + well.c * h * (s - q * T)) * S
    N = S + (C - h * S) * phi_ddot - (S + h * C) * S * squared
    pushes = Jet(np.where(N.value > 0, N.value, np.nan), N.slope)
    return jet_sqrt(F_x * F_x + squared * across * across) / pushes
