"""A can whose rim alone meets friction, compiled: force and accelerations of sticking and slipping.

The mathematics of `reference.equations.newton_euler` without moments of friction, by three
equations where the rim sticks and by one where it slips. A column of states at a time, or the
rates of several at once: the algebra is without branches, and its numbers lie in one array, so that
the compiler works on several columns by one instruction. Imported where a caller asks for compiled
code.
"""

from typing import Any

import numpy as np

from reference.equations.compiled_equations import (
    FORCE,
    MOBILITY,
    MOMENT,
    MOMENTUM,
    SHAKING,
    SLIPPING,
    TURNING,
    VELOCITY,
)
from reference.equations.state_vector import (
    LEAN,
    PSI,
    TIME,
    TOTAL,
    U1,
    U2,
    W1,
    W2,
    W3,
)
from reference.numerics.compiled import inlined, inner, jit
from reference.problem.states import Floats

Constants = tuple[float, ...]
"""The constants of `CompiledEquations`, as numbers."""
Numbers = tuple[Any, ...]
"""Real, or complex for derivatives."""

WIDTH = 16
"""Columns whose rates are computed at once: those of a step."""
# Rows of what is worked with: the state as far as rates depend on it, what is no algebra of it
# (tan(phi/2), cosine and sine of psi and of theta, the wave of the shaking), and rates.
_INPUTS = U2 + 1
_TANGENT, _COS_PSI, _SIN_PSI, _COS_THETA, _SIN_THETA, _WAVE = range(_INPUTS, _INPUTS + 6)
_RATES = _INPUTS + 6
WORK_ROWS = _RATES + 5


@inlined
def _constants(E: Floats) -> Constants:
    """Return the constants as numbers."""
    return (
        E[0], E[1], E[2], E[3], E[4], E[5], E[6], E[7], E[8], E[9], E[10],
        E[11], E[12], E[13], E[14], E[15], E[16], E[17], E[18], E[19], E[20],
    )  # fmt: skip


@inlined
def _posed(c: Constants, w: Numbers, trig: Numbers) -> tuple[Numbers, Numbers, Numbers, Numbers]:
    """Return inertia about the centre, arm to the contact, gravity and shaking, and motions.

    Of a turning (w1, w2, w3), and the functions of the angles. The motions are w x p, and that of
    the contact through the body; the last is S theta'.
    """
    T, cos_psi, sin_psi, cos_theta, sin_theta, wave = trig
    w1, w2, w3 = w
    r, M = c[20], 1 + c[3]
    over = 1 / (1 + T * T)
    S, C = 2 * T * over, (1 - T) * (1 + T) * over
    d1, d2, d3 = c[4] * cos_theta - c[5] * sin_theta, c[4] * sin_theta + c[5] * cos_theta, c[6]
    part = c[3] / M
    I11, I22 = c[0] + part * (d2 * d2 + d3 * d3), c[0] + part * (d1 * d1 + d3 * d3)
    I33 = c[1] + part * (d1 * d1 + d2 * d2)
    I12, I13, I23 = -part * d1 * d2, -part * d1 * d3, -part * d2 * d3
    p1, p2 = -(1 - r) - r * S - part * d1, -part * d2
    p3 = -(c[2] - r) - r * C - part * d3
    s1, s2, s3 = c[10] * wave, c[11] * wave, c[12] * wave
    g1, g2, g3 = c[7] + s1, c[8] + s2, c[9] + s3
    g1, g2 = cos_psi * g1 + sin_psi * g2, cos_psi * g2 - sin_psi * g1
    s1, s2 = cos_psi * s1 + sin_psi * s2, cos_psi * s2 - sin_psi * s1
    rotation = S * w3 - C * w1
    l1, l2, l3 = w2 * p3 - w3 * p2, w3 * p1 - w1 * p3, w1 * p2 - w2 * p1
    k1 = r * S * C * w2 + S * l1
    k2 = (1 - r + r * S) * rotation + S * l2
    k3 = S * l3 - r * S * S * w2
    inertia = I11, I22, I33, I12, I13, I23
    return inertia, (p1, p2, p3, S, C), (g1, g2, g3, s1, s2, s3), (l1, l2, l3, k1, k2, k3, rotation)


@inlined
def _stuck(
    c: Constants, w: Numbers, trig: Numbers
) -> tuple[Numbers, Numbers, Numbers, Numbers, Numbers, Numbers]:
    """Return turning, force, velocity of the centre, shaking, momentum, and S theta' of sticking.

    Three equations instead of six, of the turning about the contact: with a_G = -w' x p - w x dp/dt

        (I + M (p.p 1 - p p^T)) w' = -w x I w - nu I w - M p x (g - lambda v + w x dp/dt).
    """
    w1, w2, w3 = w
    linear, angular, M = c[18], c[19], 1 + c[3]
    inertia, arm, pulls, motions = _posed(c, w, trig)
    I11, I22, I33, I12, I13, I23 = inertia
    p1, p2, p3, S, C = arm
    g1, g2, g3, s1, s2, s3 = pulls
    l1, l2, l3, k1, k2, k3, rotation = motions
    # the velocity of the centre is -l
    e1 = S * (C * g1 + S * g3 + linear * l1) + w2 * k3 - w3 * k2
    e2 = S * (g2 + linear * l2) + w3 * k1 - w1 * k3
    e3 = S * (C * g3 - S * g1 + linear * l3) + w1 * k2 - w2 * k1
    H1 = I11 * w1 + I12 * w2 + I13 * w3
    H2 = I12 * w1 + I22 * w2 + I23 * w3
    H3 = I13 * w1 + I23 * w2 + I33 * w3
    t1 = S * (w3 * H2 - w2 * H3 - angular * H1) - M * (p2 * e3 - p3 * e2)
    t2 = S * (w1 * H3 - w3 * H1 - angular * H2) - M * (p3 * e1 - p1 * e3)
    t3 = S * (w2 * H1 - w1 * H2 - angular * H3) - M * (p1 * e2 - p2 * e1)
    J11, J22 = I11 + M * (p2 * p2 + p3 * p3), I22 + M * (p1 * p1 + p3 * p3)
    J33 = I33 + M * (p1 * p1 + p2 * p2)
    J12, J13, J23 = I12 - M * p1 * p2, I13 - M * p1 * p3, I23 - M * p2 * p3
    A11, A12, A13 = J22 * J33 - J23 * J23, J13 * J23 - J12 * J33, J12 * J23 - J13 * J22
    A22, A23, A33 = J11 * J33 - J13 * J13, J12 * J13 - J11 * J23, J11 * J22 - J12 * J12
    over = 1 / (J11 * A11 + J12 * A12 + J13 * A13)
    a1 = (A11 * t1 + A12 * t2 + A13 * t3) * over
    a2 = (A12 * t1 + A22 * t2 + A23 * t3) * over
    a3 = (A13 * t1 + A23 * t2 + A33 * t3) * over
    F1 = -M * (a2 * p3 - a3 * p2 + e1)
    F2 = -M * (a3 * p1 - a1 * p3 + e2)
    F3 = -M * (a1 * p2 - a2 * p1 + e3)
    force = C * F1 - S * F3, F2, S * F1 + C * F3
    velocity = -C * l1 + S * l3, -l2, -S * l1 - C * l3
    return (
        (a1, a2, a3),
        force,
        velocity,
        (M * s1, M * s2, M * s3),
        (H1, H2, H3),
        (rotation, S),
    )


@inlined
def _slid(
    c: Constants, w: Numbers, u: Numbers, trig: Numbers
) -> tuple[Numbers, Numbers, Numbers, Numbers, Numbers, Numbers, Numbers]:
    """Return turning, force, velocity, shaking, momentum, S theta', and the acceleration of a slip.

    One equation instead of six: the rim yields along the normal to the normal force and to the
    friction that this brings with it, and stays on the plane. Analytic in the state. The last are
    the two accelerations of the slip and the normal mobility.
    """
    w1, w2, w3 = w
    u1, u2 = u
    mu, linear, angular, M = c[15], c[18], c[19], 1 + c[3]
    inertia, arm, pulls, motions = _posed(c, w, trig)
    I11, I22, I33, I12, I13, I23 = inertia
    p1, p2, p3, S, C = arm
    g1, g2, g3, s1, s2, s3 = pulls
    l1, l2, l3, k1, k2, k3, rotation = motions
    A11, A12, A13 = I22 * I33 - I23 * I23, I13 * I23 - I12 * I33, I12 * I23 - I13 * I22
    A22, A23, A33 = I11 * I33 - I13 * I13, I12 * I13 - I11 * I23, I11 * I22 - I12 * I12
    over = 1 / (I11 * A11 + I12 * A12 + I13 * A13)
    A11, A12, A13 = A11 * over, A12 * over, A13 * over
    A22, A23, A33 = A22 * over, A23 * over, A33 * over
    v1, v2, v3 = C * u1 - l1, u2 - l2, -S * u1 - l3
    H1 = I11 * w1 + I12 * w2 + I13 * w3
    H2 = I12 * w1 + I22 * w2 + I23 * w3
    H3 = I13 * w1 + I23 * w2 + I33 * w3
    t1 = S * (w3 * H2 - w2 * H3 - angular * H1)
    t2 = S * (w1 * H3 - w3 * H1 - angular * H2)
    t3 = S * (w2 * H1 - w1 * H2 - angular * H3)
    f1 = A11 * t1 + A12 * t2 + A13 * t3
    f2 = A12 * t1 + A22 * t2 + A23 * t3
    f3 = A13 * t1 + A23 * t2 + A33 * t3
    q1 = f2 * p3 - f3 * p2 + w2 * k3 - w3 * k2 - S * linear * v1 + S * (C * g1 + S * g3)
    q2 = f3 * p1 - f1 * p3 + w3 * k1 - w1 * k3 - S * linear * v2 + S * g2
    q3 = f1 * p2 - f2 * p1 + w1 * k2 - w2 * k1 - S * linear * v3 + S * (C * g3 - S * g1)
    # the force of a unit of normal force, and what it does
    size = max(abs(u1.real), abs(u2.real))
    n1, n2 = u1 / size, u2 / size
    speed = np.sqrt(n1 * n1 + n2 * n2)
    n1, n2 = -mu * n1 / speed, -mu * n2 / speed
    e1, e2, e3 = C * n1 + S, n2, C - S * n1
    m1, m2, m3 = p2 * e3 - p3 * e2, p3 * e1 - p1 * e3, p1 * e2 - p2 * e1
    b1 = A11 * m1 + A12 * m2 + A13 * m3
    b2 = A12 * m1 + A22 * m2 + A23 * m3
    b3 = A13 * m1 + A23 * m2 + A33 * m3
    c1 = b2 * p3 - b3 * p2 + e1 / M
    c2 = b3 * p1 - b1 * p3 + e2 / M
    c3 = b1 * p2 - b2 * p1 + e3 / M
    yields = S * c1 + C * c3
    N = -(S * q1 + C * q3) / yields
    q1, q2, q3 = q1 + N * c1, q2 + N * c2, q3 + N * c3
    velocity = C * v1 - S * v3, v2, S * v1 + C * v3
    return (
        (f1 + N * b1, f2 + N * b2, f3 + N * b3),
        (N * n1, N * n2, N),
        velocity,
        (M * s1, M * s2, M * s3),
        (H1, H2, H3),
        (rotation, S),
        (C * q1 - S * q3, q2, yields * M),
    )


@inlined
def _functions(E: Floats, y: Floats, j: int) -> Numbers:
    """Return tan(phi/2), cosine and sine of psi and of theta, and the wave of the shaking."""
    T = np.exp(y[LEAN, j])
    zero = 0 * T
    cos_psi, sin_psi, cos_theta, sin_theta, wave = 1 + zero, zero, 1 + zero, zero, zero
    if E[3] > 0:
        theta = y[TOTAL, j] - y[PSI, j]
        cos_theta, sin_theta = np.cos(theta), np.sin(theta)
    if E[10] != 0 or E[11] != 0 or E[12] != 0:
        wave = np.sin(E[13] * y[TIME, j] + E[14])
    if E[7] != 0 or E[8] != 0 or E[10] != 0 or E[11] != 0:
        cos_psi, sin_psi = np.cos(y[PSI, j]), np.sin(y[PSI, j])
    return T, cos_psi, sin_psi, cos_theta, sin_theta, wave


@inlined
def _write(here: Floats, found: tuple[Numbers, Numbers, Numbers, Numbers, Numbers]) -> None:
    """Write turning, force, velocity, shaking and momentum to `here`."""
    turning, force, velocity, shaking, momentum = found
    for i in range(3):
        here[MOMENT + i] = 0.0
        here[TURNING + i], here[FORCE + i], here[VELOCITY + i] = turning[i], force[i], velocity[i]
        here[SHAKING + i], here[MOMENTUM + i] = shaking[i], momentum[i]


@jit
def sticking_at(E: Floats, y: Floats, j: int, here: Floats) -> None:
    """Write the contact of a can that sticks, and that no moment of friction resists, to `here`.

    The normal mobility is left out: no event of such a can needs it.
    """
    w = y[W1, j], y[W2, j], y[W3, j]
    found = _stuck(_constants(E), w, _functions(E, y, j))
    _write(here, found[:5])
    here[SLIPPING] = here[SLIPPING + 1] = here[MOBILITY] = 0.0


@jit
def slipping_at(E: Floats, y: Floats, j: int, here: Floats) -> None:
    """Write the contact of a can that slips, and that no moment of friction resists, to `here`."""
    w, u = (y[W1, j], y[W2, j], y[W3, j]), (y[U1, j], y[U2, j])
    found = _slid(_constants(E), w, u, _functions(E, y, j))
    _write(here, found[:5])
    here[SLIPPING], here[SLIPPING + 1], here[MOBILITY] = found[6]


@inner
def _write_functions(E: Floats, y: Floats, b: Floats) -> None:
    """Write `_functions` of `WIDTH` columns to b; what an effect needs is asked for once."""
    for j in range(WIDTH):
        b[_TANGENT * WIDTH + j] = np.exp(y[LEAN, j])
        b[_COS_PSI * WIDTH + j] = b[_COS_THETA * WIDTH + j] = 1.0
        b[_SIN_PSI * WIDTH + j] = b[_SIN_THETA * WIDTH + j] = b[_WAVE * WIDTH + j] = 0.0
    if E[3] > 0:
        for j in range(WIDTH):
            theta = y[TOTAL, j] - y[PSI, j]
            b[_COS_THETA * WIDTH + j], b[_SIN_THETA * WIDTH + j] = np.cos(theta), np.sin(theta)
    if E[10] != 0 or E[11] != 0 or E[12] != 0:
        for j in range(WIDTH):
            b[_WAVE * WIDTH + j] = np.sin(E[13] * y[TIME, j] + E[14])
    if E[7] != 0 or E[8] != 0 or E[10] != 0 or E[11] != 0:
        for j in range(WIDTH):
            psi = y[PSI, j]
            b[_COS_PSI * WIDTH + j], b[_SIN_PSI * WIDTH + j] = np.cos(psi), np.sin(psi)


@jit
def rim_rates(E: Floats, slips: bool, y: Floats, b: Floats, f: Floats) -> None:
    """Write the rates of turning and slip of `WIDTH` columns to those rows of f.

    Parameters
    ----------
    E : ndarray, shape (21,)
    slips : bool
    y : ndarray, shape (13, WIDTH)
    b : ndarray, shape (WORK_ROWS * WIDTH,)
        To work in.
    f : ndarray, shape (13, WIDTH)
    """
    c = _constants(E)
    for i in range(_INPUTS):
        for j in range(WIDTH):
            b[i * WIDTH + j] = y[i, j]
    _write_functions(E, y, b)
    if slips:
        for j in range(WIDTH):
            w1, w2, w3 = b[W1 * WIDTH + j], b[W2 * WIDTH + j], b[W3 * WIDTH + j]
            u1, u2 = b[U1 * WIDTH + j], b[U2 * WIDTH + j]
            found = _slid(c, (w1, w2, w3), (u1, u2), _trig(b, j))
            b[_RATES * WIDTH + j] = found[0][0] - found[5][0] * w2
            b[(_RATES + 1) * WIDTH + j] = found[0][1] + found[5][0] * w1
            b[(_RATES + 2) * WIDTH + j] = found[0][2]
            b[(_RATES + 3) * WIDTH + j] = found[6][0] + w1 * u2
            b[(_RATES + 4) * WIDTH + j] = found[6][1] - w1 * u1
    else:
        for j in range(WIDTH):
            w1, w2, w3 = b[W1 * WIDTH + j], b[W2 * WIDTH + j], b[W3 * WIDTH + j]
            held = _stuck(c, (w1, w2, w3), _trig(b, j))
            b[_RATES * WIDTH + j] = held[0][0] - held[5][0] * w2
            b[(_RATES + 1) * WIDTH + j] = held[0][1] + held[5][0] * w1
            b[(_RATES + 2) * WIDTH + j] = held[0][2]
            b[(_RATES + 3) * WIDTH + j] = b[(_RATES + 4) * WIDTH + j] = 0.0
    for j in range(WIDTH):
        f[W1, j], f[W2, j] = b[_RATES * WIDTH + j], b[(_RATES + 1) * WIDTH + j]
        f[W3, j] = b[(_RATES + 2) * WIDTH + j]
        f[U1, j], f[U2, j] = b[(_RATES + 3) * WIDTH + j], b[(_RATES + 4) * WIDTH + j]


@inlined
def _trig(b: Floats, j: int) -> Numbers:
    """Return what is no algebra of a column."""
    return (
        b[_TANGENT * WIDTH + j],
        b[_COS_PSI * WIDTH + j],
        b[_SIN_PSI * WIDTH + j],
        b[_COS_THETA * WIDTH + j],
        b[_SIN_THETA * WIDTH + j],
        b[_WAVE * WIDTH + j],
    )
