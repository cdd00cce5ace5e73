"""A can whose rim alone meets friction, compiled: force and accelerations of sticking and slipping.

The mathematics of `reference.equations.newton_euler` without moments of friction, by three
equations where the rim sticks and by one where it slips. Imported where a caller asks for compiled
code.
"""

import numpy as np

from reference.equations.compiled_equations import (
    FORCE,
    MOBILITY,
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
from reference.numerics.compiled import jit
from reference.problem.states import Floats


@jit
def sticking_at(E: Floats, y: Floats, j: int, here: Floats) -> None:
    """Write the contact of a can that sticks, and that no moment of friction resists, to `here`.

    Three equations instead of six, of the turning about the contact: with a_G = -w' x p - w x dp/dt

        (I + M (p.p 1 - p p^T)) w' = -w x I w - nu I w - M p x (g - lambda v + w x dp/dt).

    The normal mobility is left out: no event of such a can needs it.
    """
    share, r, linear, angular = E[3], E[20], E[18], E[19]
    w1, w2, w3 = y[W1, j], y[W2, j], y[W3, j]
    T = np.exp(y[LEAN, j])
    S, C = 2 * T / (1 + T * T), (1 - T) * (1 + T) / (1 + T * T)
    M, d1, d2, d3 = 1.0, 0.0, 0.0, 0.0
    I11, I22, I33, I12, I13, I23 = E[0], E[0], E[1], 0.0, 0.0, 0.0
    if share > 0:
        theta = y[TOTAL, j] - y[PSI, j]
        cosine, sine = np.cos(theta), np.sin(theta)
        d1, d2, d3 = E[4] * cosine - E[5] * sine, E[4] * sine + E[5] * cosine, E[6]
        M = 1 + share
        part = share / M
        I11 += part * (d2 * d2 + d3 * d3)
        I22 += part * (d1 * d1 + d3 * d3)
        I33 += part * (d1 * d1 + d2 * d2)
        I12, I13, I23 = -part * d1 * d2, -part * d1 * d3, -part * d2 * d3
        d1, d2, d3 = part * d1, part * d2, part * d3
    p1, p2, p3 = -(1 - r) - r * S - d1, -d2, -(E[2] - r) - r * C - d3
    g1, g2, g3 = E[7], E[8], E[9]
    s1, s2, s3 = 0.0, 0.0, 0.0
    shaken = E[10] != 0 or E[11] != 0 or E[12] != 0
    if shaken:
        wave = np.sin(E[13] * y[TIME, j] + E[14])
        s1, s2, s3 = E[10] * wave, E[11] * wave, E[12] * wave
        g1, g2, g3 = g1 + s1, g2 + s2, g3 + s3
    if shaken or g1 != 0 or g2 != 0:
        cosine, sine = np.cos(y[PSI, j]), np.sin(y[PSI, j])
        g1, g2 = cosine * g1 + sine * g2, cosine * g2 - sine * g1
        s1, s2 = cosine * s1 + sine * s2, cosine * s2 - sine * s1
    rotation = S * w3 - C * w1
    l1, l2, l3 = w2 * p3 - w3 * p2, w3 * p1 - w1 * p3, w1 * p2 - w2 * p1
    k1, k2, k3 = (
        r * S * C * w2 + S * l1,
        (1 - r + r * S) * rotation + S * l2,
        -r * S * S * w2 + S * l3,
    )
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
    F3 = -M * (a1 * p2 - a2 * p1 + e3)
    here[:] = 0.0
    here[FORCE], here[FORCE + 2] = C * F1 - S * F3, S * F1 + C * F3
    here[FORCE + 1] = -M * (a3 * p1 - a1 * p3 + e2)
    here[TURNING], here[TURNING + 1], here[TURNING + 2] = a1, a2, a3
    here[VELOCITY], here[VELOCITY + 1], here[VELOCITY + 2] = -C * l1 + S * l3, -l2, -S * l1 - C * l3
    here[SHAKING], here[SHAKING + 1], here[SHAKING + 2] = M * s1, M * s2, M * s3
    here[MOMENTUM], here[MOMENTUM + 1], here[MOMENTUM + 2] = H1, H2, H3


@jit
def slipping_at(E: Floats, y: Floats, j: int, here: Floats) -> None:
    """Write the contact of a can that slips, and that no moment of friction resists, to `here`.

    One equation instead of six: the rim yields along the normal to the normal force and to the
    friction that this brings with it, and stays on the plane. Analytic in the state.
    """
    share, r, linear, angular, mu = E[3], E[20], E[18], E[19], E[15]
    lean, w1, w2, w3, u1, u2 = y[LEAN, j], y[W1, j], y[W2, j], y[W3, j], y[U1, j], y[U2, j]
    T = np.exp(lean)
    S, C = 2 * T / (1 + T * T), (1 - T) * (1 + T) / (1 + T * T)
    zero = 0 * lean
    M, d1, d2, d3 = 1.0, zero, zero, zero
    I11, I22, I33, I12, I13, I23 = E[0] + zero, E[0] + zero, E[1] + zero, zero, zero, zero
    A11, A22, A33, A12, A13, A23 = 1 / I11, 1 / I22, 1 / I33, zero, zero, zero
    if share > 0:
        theta = y[TOTAL, j] - y[PSI, j]
        cosine, sine = np.cos(theta), np.sin(theta)
        d1, d2, d3 = E[4] * cosine - E[5] * sine, E[4] * sine + E[5] * cosine, E[6] + zero
        M = 1 + share
        part = share / M
        I11 += part * (d2 * d2 + d3 * d3)
        I22 += part * (d1 * d1 + d3 * d3)
        I33 += part * (d1 * d1 + d2 * d2)
        I12, I13, I23 = -part * d1 * d2, -part * d1 * d3, -part * d2 * d3
        d1, d2, d3 = part * d1, part * d2, part * d3
        A11, A12, A13 = I22 * I33 - I23 * I23, I13 * I23 - I12 * I33, I12 * I23 - I13 * I22
        A22, A23, A33 = I11 * I33 - I13 * I13, I12 * I13 - I11 * I23, I11 * I22 - I12 * I12
        over = 1 / (I11 * A11 + I12 * A12 + I13 * A13)
        A11, A12, A13, A22, A23, A33 = (
            A11 * over,
            A12 * over,
            A13 * over,
            A22 * over,
            A23 * over,
            A33 * over,
        )
    p1, p2, p3 = -(1 - r) - r * S - d1, -d2, -(E[2] - r) - r * C - d3
    g1, g2, g3 = E[7] + zero, E[8] + zero, E[9] + zero
    s1, s2, s3 = zero, zero, zero
    shaken = E[10] != 0 or E[11] != 0 or E[12] != 0
    if shaken:
        wave = np.sin(E[13] * y[TIME, j] + E[14])
        s1, s2, s3 = E[10] * wave, E[11] * wave, E[12] * wave
        g1, g2, g3 = g1 + s1, g2 + s2, g3 + s3
    if shaken or E[7] != 0 or E[8] != 0:
        cosine, sine = np.cos(y[PSI, j]), np.sin(y[PSI, j])
        g1, g2 = cosine * g1 + sine * g2, cosine * g2 - sine * g1
        s1, s2 = cosine * s1 + sine * s2, cosine * s2 - sine * s1
    rotation = S * w3 - C * w1
    l1, l2, l3 = w2 * p3 - w3 * p2, w3 * p1 - w1 * p3, w1 * p2 - w2 * p1
    v1, v2, v3 = C * u1 - l1, u2 - l2, -S * u1 - l3
    k1, k2, k3 = (
        r * S * C * w2 + S * l1,
        (1 - r + r * S) * rotation + S * l2,
        -r * S * S * w2 + S * l3,
    )
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
    here[:] = zero
    here[FORCE], here[FORCE + 1], here[FORCE + 2] = N * n1, N * n2, N
    here[TURNING], here[TURNING + 1], here[TURNING + 2] = f1 + N * b1, f2 + N * b2, f3 + N * b3
    here[SLIPPING], here[SLIPPING + 1] = C * q1 - S * q3, q2
    here[MOBILITY] = yields * M
    here[VELOCITY], here[VELOCITY + 1], here[VELOCITY + 2] = C * v1 - S * v3, v2, S * v1 + C * v3
    here[SHAKING], here[SHAKING + 1], here[SHAKING + 2] = M * s1, M * s2, M * s3
    here[MOMENTUM], here[MOMENTUM + 1], here[MOMENTUM + 2] = H1, H2, H3
