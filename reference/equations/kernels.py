"""The general can, compiled: force, accelerations and rates at one state after another.

The mathematics of `reference.equations.newton_euler`, in numbers instead of arrays; a can with
friction alone (`reference.equations.coulomb`) is one of them. Everything is analytic in the state:
complex states, for which the kernels are compiled when first met, give derivatives. Imported where
a caller asks for compiled code.
"""

import numpy as np

from reference.equations.compiled_equations import (
    CONTACT_ROWS,
    FORCE,
    MOBILITY,
    MOMENT,
    MOMENTUM,
    SHAKING,
    SLIPPING,
    TURNING,
    VELOCITY,
    Laws,
)
from reference.equations.newton_euler import (
    NORMAL,
    ROLLING_1,
    ROLLING_2,
    SLIP_1,
    SLIP_2,
    TURNING_Z,
)
from reference.equations.rim_kernels import slipping_at, sticking_at
from reference.equations.state_vector import (
    DISSIPATED,
    LEAN,
    PSI,
    ROWS,
    SUPPLIED,
    TIME,
    TOTAL,
    U1,
    U2,
    W1,
    W2,
    W3,
    X,
    Y,
)
from reference.numerics.compiled import inner, jit
from reference.problem.states import Floats


@inner
def false_and_zero(E: Floats) -> tuple[bool, int]:
    """Return False and 0 as variables, for arguments of kernels that are the same in each call.

    numba gives each constant a type of its own, and compiles all of a kernel once more for it.
    """
    return E.size < 0, E.size - E.size


@inner
def contact_at(E: Floats, laws: Laws, y: Floats, j: int, D: Floats, here: Floats) -> None:
    """Write the contact of column j of states (13, n) to `here`.

    Parameters
    ----------
    E : ndarray, shape (21,)
        Of `CompiledEquations`.
    laws : tuple
    y : ndarray, shape (13, n), of float or complex
    j : int
    D : ndarray, shape (10, 6), of the type of y
        For the mobility and what becomes of it.
    here : ndarray, shape (CONTACT_ROWS,), of the type of y
    """
    a, c, h, share, mx, my, mz = E[0], E[1], E[2], E[3], E[4], E[5], E[6]
    mu, drilling, resistance, linear, angular, r = E[15], E[16], E[17], E[18], E[19], E[20]
    slips, turns, rests = laws
    lean, w1, w2, w3 = y[LEAN, j], y[W1, j], y[W2, j], y[W3, j]
    T = np.exp(lean)
    S, C = 2 * T / (1 + T * T), -np.tanh(lean)
    zero = 0 * lean
    # inertia about the centre of mass, and the arm from it to the contact, in frame B
    mass, d1, d2, d3 = 1.0, zero, zero, zero
    I11, I22, I33, I12, I13, I23 = a + zero, a + zero, c + zero, zero, zero, zero
    if share > 0:
        theta = y[TOTAL, j] - y[PSI, j]
        cosine, sine = np.cos(theta), np.sin(theta)
        d1, d2, d3 = mx * cosine - my * sine, mx * sine + my * cosine, mz + zero
        mass = 1 + share
        part = share / mass
        I11, I22, I33 = (
            a + part * (d2 * d2 + d3 * d3),
            a + part * (d1 * d1 + d3 * d3),
            c + part * (d1 * d1 + d2 * d2),
        )
        I12, I13, I23 = -part * d1 * d2, -part * d1 * d3, -part * d2 * d3
        d1, d2, d3 = part * d1, part * d2, part * d3
    p1, p2, p3 = -(1 - r) - r * S - d1, -d2, -(h - r) - r * C - d3
    u1, u2 = zero, zero
    if slips:
        u1, u2 = y[U1, j], y[U2, j]
    rotation = S * w3 - C * w1
    # w x p; velocity of the centre, motion of the contact through the body
    l1, l2, l3 = w2 * p3 - w3 * p2, w3 * p1 - w1 * p3, w1 * p2 - w2 * p1
    v1, v2, v3 = C * u1 - l1, u2 - l2, -S * u1 - l3
    k1, k2, k3 = (
        r * S * C * w2 + S * l1,
        (1 - r + r * S) * rotation + S * l2,
        -r * S * S * w2 + S * l3,
    )
    # gravity, and of it the shaking, in level directions
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
    # angular momentum, and what becomes of the turning without a force of contact
    H1 = I11 * w1 + I12 * w2 + I13 * w3
    H2 = I12 * w1 + I22 * w2 + I23 * w3
    H3 = I13 * w1 + I23 * w2 + I33 * w3
    t1 = -S * (w2 * H3 - w3 * H2 + angular * H1)
    t2 = -S * (w3 * H1 - w1 * H3 + angular * H2)
    t3 = -S * (w1 * H2 - w2 * H1 + angular * H3)
    if share > 0:
        A11, A12, A13 = I22 * I33 - I23 * I23, I13 * I23 - I12 * I33, I12 * I23 - I13 * I22
        A22, A23, A33 = I11 * I33 - I13 * I13, I12 * I13 - I11 * I23, I11 * I22 - I12 * I12
        det = I11 * A11 + I12 * A12 + I13 * A13
        A11, A12, A13 = A11 / det, A12 / det, A13 / det
        A22, A23, A33 = A22 / det, A23 / det, A33 / det
    else:
        A11, A22, A33, A12, A13, A23 = 1 / I11, 1 / I22, 1 / I33, zero, zero, zero
    f1 = A11 * t1 + A12 * t2 + A13 * t3
    f2 = A12 * t1 + A22 * t2 + A23 * t3
    f3 = A13 * t1 + A23 * t2 + A33 * t3
    q1 = f2 * p3 - f3 * p2 + w2 * k3 - w3 * k2 - S * linear * v1
    q2 = f3 * p1 - f1 * p3 + w3 * k1 - w1 * k3 - S * linear * v2
    q3 = f1 * p2 - f2 * p1 + w1 * k2 - w2 * k1 - S * linear * v3
    # from here on in level directions
    start = D[6]
    start[0], start[1], start[2] = C * f1 - S * f3, f2, S * f1 + C * f3
    start[3], start[4], start[5] = (
        C * q1 - S * q3 + S * g1,
        q2 + S * g2,
        S * q1 + C * q3 + S * g3,
    )
    x, z = C * p1 - S * p3, S * p1 + C * p3
    B11 = C * C * A11 - 2 * S * C * A13 + S * S * A33
    B33 = S * S * A11 + 2 * S * C * A13 + C * C * A33
    B13 = S * C * (A11 - A33) + (C * C - S * S) * A13
    B12, B23, B22 = C * A12 - S * A23, S * A12 + C * A23, A22
    D[0, 0], D[0, 1], D[0, 2] = B11, B12, B13
    D[1, 0], D[1, 1], D[1, 2] = B12, B22, B23
    D[2, 0], D[2, 1], D[2, 2] = B13, B23, B33
    for i in range(3):
        # row i of the inverse inertia times [p]x
        D[i, 3] = D[i, 1] * z - D[i, 2] * p2
        D[i, 4] = D[i, 2] * x - D[i, 0] * z
        D[i, 5] = D[i, 0] * p2 - D[i, 1] * x
    for i in range(3):
        for k in range(3):
            D[3 + i, k] = D[k, 3 + i]
    for k in range(3):
        # -[p]x times those columns
        b0, b1, b2 = D[0, 3 + k], D[1, 3 + k], D[2, 3 + k]
        D[3, 3 + k] = z * b1 - p2 * b2
        D[4, 3 + k] = x * b2 - z * b0
        D[5, 3 + k] = p2 * b0 - x * b1
        D[3 + k, 3 + k] += 1 / mass
    # what a unit of normal force brings with it
    law, answer, wrench = D[7], D[8], D[9]
    for i in range(6):
        law[i] = zero
    law[NORMAL] = 1 + zero
    if slips:
        size = max(abs(u1.real), abs(u2.real))
        n1, n2 = u1 / size, u2 / size
        speed = np.sqrt(n1 * n1 + n2 * n2)
        law[SLIP_1], law[SLIP_2] = -mu * n1 / speed, -mu * n2 / speed
    if drilling > 0 and turns != 0:
        law[TURNING_Z] = -drilling * turns + zero
    if resistance > 0 and not rests:
        n1, n2 = C * w1 - S * w3, w2
        size = max(abs(n1.real), abs(n2.real))
        n1, n2 = n1 / size, n2 / size
        speed = np.sqrt(n1 * n1 + n2 * n2)
        law[ROLLING_1], law[ROLLING_2] = -resistance * n1 / speed, -resistance * n2 / speed
    for i in range(6):
        total = zero
        for k in range(6):
            total += D[i, k] * law[k]
        answer[i] = total
    # what is held stands: the normal last, whose pivot is its mobility with the others held
    held_rolling, held_turning, held_slip = rests, drilling > 0 and turns == 0, not slips
    mobility = _hold(D, held_rolling, held_turning, held_slip)
    for i in range(6):
        total = start[i]
        for k in range(6):
            total += D[i, k] * wrench[k]
        answer[i] = total
    if held_rolling:
        answer[ROLLING_1], answer[ROLLING_2] = zero, zero
    if held_turning:
        answer[TURNING_Z] = zero
    if held_slip:
        answer[SLIP_1], answer[SLIP_2] = zero, zero
    for i in range(3):
        here[FORCE + i], here[MOMENT + i] = wrench[3 + i], wrench[i]
    here[TURNING] = C * answer[0] + S * answer[2]
    here[TURNING + 1] = answer[1]
    here[TURNING + 2] = C * answer[2] - S * answer[0]
    here[SLIPPING], here[SLIPPING + 1] = answer[SLIP_1], answer[SLIP_2]
    here[MOBILITY] = mobility * mass
    here[VELOCITY], here[VELOCITY + 1], here[VELOCITY + 2] = C * v1 - S * v3, v2, S * v1 + C * v3
    here[SHAKING], here[SHAKING + 1], here[SHAKING + 2] = mass * s1, mass * s2, mass * s3
    here[MOMENTUM], here[MOMENTUM + 1], here[MOMENTUM + 2] = H1, H2, H3


@inner
def _hold(D: Floats, rolling: bool, turning: bool, slip: bool) -> float:
    """Write the wrench that holds what is held to row 9 of D; return the last pivot.

    Elimination without exchange: all but the last row and column are of a positive definite matrix.
    """
    start, law, answer, wrench = D[6], D[7], D[8], D[9]
    if not (rolling or turning or slip):
        alone: float = answer[NORMAL]
        for i in range(6):
            wrench[i] = law[i] * (-start[NORMAL] / alone)
        return alone
    M = np.empty((6, 7), D.dtype)
    held = np.empty(6, np.int64)
    n = 0
    for row, is_held in (
        (ROLLING_1, rolling),
        (ROLLING_2, rolling),
        (TURNING_Z, turning),
        (SLIP_1, slip),
        (SLIP_2, slip),
        (NORMAL, True),
    ):
        if is_held:
            held[n] = row
            n += 1
    for i in range(n):
        for k in range(n - 1):
            M[i, k] = D[held[i], held[k]]
        M[i, n - 1], M[i, 6] = answer[held[i]], -start[held[i]]
    for i in range(n):
        for below in range(i + 1, n):
            factor = M[below, i] / M[i, i]
            for k in range(i + 1, n):
                M[below, k] -= factor * M[i, k]
            M[below, 6] -= factor * M[i, 6]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            M[i, 6] -= M[i, k] * M[k, 6]
        M[i, 6] /= M[i, i]
    for i in range(6):
        wrench[i] = law[i] * M[n - 1, 6]
    for i in range(n - 1):
        wrench[held[i]] += M[i, 6]
    pivot: float = M[n - 1, n - 1]
    return pivot


@jit
def contact_of(E: Floats, laws: Laws, y: Floats, j: int, D: Floats, here: Floats) -> None:
    """Write the contact of a column of real states to `here`, by the fewest equations."""
    if E[16] > 0 or E[17] > 0:
        contact_at(E, laws, y, j, D, here)
    elif laws[0]:
        slipping_at(E, y, j, here)
    else:
        sticking_at(E, y, j, here)


@inner
def rates_at(
    E: Floats,
    laws: Laws,
    y: Floats,
    j: int,
    here: Floats,
    out: Floats,
    along: bool,
) -> None:
    """Write the rates of column j of states (13, n), whose contact is `here`, to that of `out`."""
    slips, rests = laws[0], laws[2]
    lean, w1, w2, w3 = y[LEAN, j], y[W1, j], y[W2, j], y[W3, j]
    T = np.exp(lean)
    S, C = 2 * T / (1 + T * T), (1 - T) * (1 + T) / (1 + T * T)
    rotation = 0 * lean
    if not rests:
        rotation = S * w3 - C * w1
    out[LEAN, j] = -w2
    out[W1, j] = here[TURNING] - rotation * w2
    out[W2, j] = here[TURNING + 1] + rotation * w1
    out[W3, j] = here[TURNING + 2]
    out[PSI, j], out[TOTAL, j], out[TIME, j] = w1, S * (w3 + T * w1), S
    for row in range(U1, ROWS):
        out[row, j] = 0.0
    u1, u2 = y[U1, j], y[U2, j]
    if slips:
        out[U1, j], out[U2, j] = here[SLIPPING] + w1 * u2, here[SLIPPING + 1] - w1 * u1
    if not along:
        return
    r, linear, angular = E[20], E[18], E[19]
    ahead, aside = S * r * w2, (1 - r + r * S) * rotation
    if slips:
        ahead, aside = ahead + S * u1, aside + S * u2
        out[DISSIPATED, j] = -(here[FORCE] * u1 + here[FORCE + 1] * u2)
    cosine, sine = np.cos(y[PSI, j]), np.sin(y[PSI, j])
    out[X, j], out[Y, j] = ahead * cosine - aside * sine, ahead * sine + aside * cosine
    l1, l3 = C * w1 - S * w3, S * w1 + C * w3
    out[DISSIPATED, j] -= here[MOMENT] * l1 + here[MOMENT + 1] * w2 + here[MOMENT + 2] * l3
    v1, v2, v3 = here[VELOCITY], here[VELOCITY + 1], here[VELOCITY + 2]
    drag = linear * (1 + E[3]) * (v1 * v1 + v2 * v2 + v3 * v3)
    drag += angular * (w1 * here[MOMENTUM] + w2 * here[MOMENTUM + 1] + w3 * here[MOMENTUM + 2])
    out[DISSIPATED, j] += S * drag
    out[SUPPLIED, j] = S * (v1 * here[SHAKING] + v2 * here[SHAKING + 1] + v3 * here[SHAKING + 2])


@jit
def contacts(E: Floats, laws: Laws, y: Floats) -> Floats:
    """Return the contacts of states (13, n), shape (CONTACT_ROWS, n)."""
    D, here = np.empty((10, 6), y.dtype), np.empty(CONTACT_ROWS, y.dtype)
    out = np.empty((CONTACT_ROWS, y.shape[1]), y.dtype)
    for j in range(y.shape[1]):
        contact_at(E, laws, y, j, D, here)
        for i in range(CONTACT_ROWS):
            out[i, j] = here[i]
    return out


@jit
def rates(E: Floats, laws: Laws, y: Floats, along: bool) -> Floats:
    """Return the rates of states (13, n), shape (13, n)."""
    D, here = np.empty((10, 6), y.dtype), np.empty(CONTACT_ROWS, y.dtype)
    out = np.empty_like(y)
    for j in range(y.shape[1]):
        contact_at(E, laws, y, j, D, here)
        rates_at(E, laws, y, j, here, out, along)
    return out
