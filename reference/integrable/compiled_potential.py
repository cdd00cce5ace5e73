"""The potential well of one release at a time, compiled to machine code.

The mathematics of `reference.integrable.frobenius` and `reference.integrable.effective_potential`
in scalars, but for what hard releases need there: the mean force beside an equilibrium. Polynomials
are evaluated at all nutations together, which the compiler turns into vector instructions; sine is
a series for the same reason.

A can is an array of `CAN` numbers: a, c, h, k, a_p, c_p, the residue and sqrt(1 + h^2). A well is one of `WELL` numbers: the reference nutation r,
b, s, B, sin r, cos r, phi* - r, and g at r.

Needs numba (`reference.numerics.compiled`).
"""

import math

import numpy as np

from reference.integrable.effective_potential import UNCERTAIN
from reference.integrable.frobenius import MOST_TERMS, trigonometric_series
from reference.numerics.compiled import jit
from reference.problem.states import Floats

CAN, WELL = 8, 8
EPS = 2.0**-52
_MOST_TERMS = MOST_TERMS
_NOISE = UNCERTAIN * EPS
_SINES = np.array([(-1.0) ** n / math.factorial(2 * n + 1) for n in range(12)][::-1])
"""Of (sin x)/x in powers of x^2, highest first: to 1e-19 up to pi/2."""
_TRIGONOMETRIC = np.array(trigonometric_series(MOST_TERMS))


@jit
def sine(x: float) -> float:
    """Return sin x for |x| <= pi/2."""
    square, value = x * x, _SINES[0]
    for n in range(1, _SINES.size):
        value = value * square + _SINES[n]
    return x * value


@jit
def terms_for(phi: float) -> int:
    """Return as many terms as `reference.integrable.frobenius.terms_needed`."""
    return min(_MOST_TERMS, int(6.0 + 40.0 / math.log(math.pi / phi)))


@jit
def extend_series(can: Floats, known: int, terms: int, series: Floats) -> None:
    """Continue b1, s1, b2, s2, rows of `series`, by the recurrence of `frobenius_series`."""
    k, L = can[3], can[6]
    kc, hk, ka = k * can[5], can[2] * k, k * can[4]
    for n in range(known, terms):
        for second in range(2):
            b, s = series[2 * second], series[2 * second + 1]
            if n == 0:
                b[0], s[0] = float(second), 1.0 - float(second)
                continue
            to_b, to_s = -hk * b[n - 1], hk * s[n - 1]
            for m in range(n):
                back = n - 1 - m
                to_b += kc * (_TRIGONOMETRIC[0, back] * s[m] - _TRIGONOMETRIC[1, back] * b[m])
                to_s += kc * (_TRIGONOMETRIC[1, back] * s[m] - _TRIGONOMETRIC[3, back] * b[m])
                to_s -= 2.0 * hk * _TRIGONOMETRIC[2, back] * b[m]
            if second:
                to_b -= L * series[0, n]
            b[n] = to_b / n
            for m in range(n + 1):
                to_s += (_TRIGONOMETRIC[5, n - m] - ka * _TRIGONOMETRIC[4, n - m]) * b[m]
            if second:
                to_s -= L * series[1, n]
            s[n] = to_s / n


@jit
def force(can: Floats, well: Floats) -> float:
    """Return dg/dphi at the reference, as `effective_potential.nutation_force`."""
    S, C = well[4], well[5]
    T, q = S / (1.0 + C), well[1] / S
    bend = can[4] * C + can[5] * T * S + can[2] * T * (1.0 + 2.0 * C)
    kinetic = q * (q * bend - (can[5] * S + can[2] * C) * well[2]) / S
    return kinetic - can[7] * math.sin(well[6])


@jit
def refer(series: Floats, terms: int, well: Floats, released: bool, polynomials: Floats) -> None:
    """Fill the polynomials of a well in which r, b, s, the sine and cosine of r are set.

    The rows are b1, s1, the divided differences at r of the parts of b and of s that have no
    logarithm, and that part of b. B is set from b and s at the release, and is kept elsewhere.
    """
    r, b, s = well[0], well[1], well[2]
    b1 = s1 = b2 = s2 = 0.0
    for n in range(terms - 1, -1, -1):
        b1 = b1 * r + series[0, n]
        s1 = s1 * r + series[1, n]
        b2 = b2 * r + series[2, n]
        s2 = s2 * r + series[3, n]
    if released:
        well[3] = b * s1 - s * b1
    B, branch = well[3], s * b2 - b * s2
    carry_b = carry_s = 0.0
    for n in range(terms - 1, -1, -1):
        part_b = branch * series[0, n] + B * series[2, n]
        part_s = branch * series[1, n] + B * series[3, n]
        polynomials[0, n], polynomials[1, n], polynomials[4, n] = series[0, n], series[1, n], part_b
        polynomials[2, n], polynomials[3, n] = carry_b, carry_s
        carry_b = part_b + r * carry_b
        carry_s = part_s + r * carry_s


@jit
def evaluate(
    can: Floats,
    well: Floats,
    polynomials: Floats,
    terms: int,
    phi: Floats,
    below: Floats,
    count: int,
    state: Floats,
    work: Floats,
) -> None:
    """Fill rows of `state` with b, spin, sin phi and g/(r - phi) at `count` nutations."""
    a, c, h, residue, balance = can[0], can[1], can[2], can[6], can[7]
    r, b_r, s_r, B = well[0], well[1], well[2], well[3]
    S_r, C_r, short, excess = well[4], well[5], well[6], well[7]
    for row in range(5):
        for j in range(count):
            work[row, j] = polynomials[row, terms - 1]
    for n in range(terms - 2, -1, -1):
        p0, p1, p2 = polynomials[0, n], polynomials[1, n], polynomials[2, n]
        p3, p4 = polynomials[3, n], polynomials[4, n]
        for j in range(count):
            x = phi[j]
            work[0, j] = work[0, j] * x + p0
            work[1, j] = work[1, j] * x + p1
            work[2, j] = work[2, j] * x + p2
            work[3, j] = work[3, j] * x + p3
            work[4, j] = work[4, j] * x + p4
    for j in range(count):
        share = below[j] / r
        work[5, j] = math.log(phi[j] / r) if share > 0.75 else math.log1p(-share)
    q_r, tilt_r = b_r / S_r, b_r / (1.0 + C_r)
    w_r = s_r - tilt_r
    v_r = w_r - h * q_r
    for j in range(count):
        down, x = below[j], phi[j]
        log = work[5, j] * B * residue
        log_b = log * work[0, j]
        deep = down > 0.75 * r
        near = log_b - down * work[2, j]
        far = log_b + work[4, j]
        b = far if deep else b_r + near
        db = far - b_r if deep else near
        ds = log * work[1, j] - down * work[3, j]
        S, half = sine(x), sine(0.5 * down)
        other = math.sqrt(1.0 - half * half)
        dS = -2.0 * half * (C_r * other + S_r * half)
        dC = 2.0 * half * (S_r * other - C_r * half)
        C = C_r + dC
        dq = b / S - q_r if deep else (db * S_r - b_r * dS) / (S * S_r)
        dw = ds - (db * (1.0 + C_r) - b_r * dC) / ((1.0 + C) * (1.0 + C_r))
        dv = dw - h * dq
        kinetic = 0.5 * (
            a * dq * (2.0 * q_r + dq) + c * dw * (2.0 * w_r + dw) + dv * (2.0 * v_r + dv)
        )
        lean = 2.0 * half * balance * sine(short + 0.5 * down)
        state[0, j] = b
        state[1, j] = s_r + ds
        state[2, j] = S
        state[3, j] = (excess + lean - kinetic) / down


@jit
def noise(can: Floats, well: Floats, phi: float, below: float, b: float, s: float) -> float:
    """Return the round-off of g at one nutation, as `effective_potential.energy_noise` has it."""
    a, c, h = can[0], can[1], can[2]
    r, b_r, s_r = well[0], abs(well[1]), abs(well[2])
    b_size = b_r + s_r * min(r, phi) * r
    s_size = s_r + b_r * (1.0 + abs(math.log(phi / r)))
    sums = 0.0
    for top in range(2):
        S, C = (well[4], well[5]) if top else (sine(phi), math.cos(phi))
        b_at, s_at = (b_r, s_r) if top else (abs(b), abs(s))
        q, w = b_at / S, s_at + b_at / (1.0 + C)
        dq = (b_at + b_size) / S
        dw = w + s_size + b_size
        sums += a * q * dq + c * w * dw + (w + h * q) * (dw + h * dq)
    lean = can[7] * abs(well[6] + 0.5 * below)
    return _NOISE * (sums * min(1.0, below / phi) + lean * below)
