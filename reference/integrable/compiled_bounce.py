"""The exact bounce of one release after another, compiled to machine code.

The same mathematics as `reference.integrable.cycle` in scalars, for releases that fall from rest
and are not hard: the well referred to the release, phi_min by a secant in sin^2 phi, the midpoint
rule on the elliptic clock. Each value is checked as there; a release with a value in doubt is left
to the arrays of `reference.integrable.cycle`, which know what to do with it.

Needs numba. Polynomials are evaluated at all nodes together, which the compiler turns into vector
instructions; sine and cosine are series for the same reason.
"""

import math

import numba
import numpy as np

from reference.problem.states import Floats

MOST_NODES = 64
"""Releases that need more nodes are left to the arrays."""

_NODES = MOST_NODES
_EPS = 2.0**-52
_DONE, _LEFT = 1, 0

_SINES = np.array([(-1.0) ** n / math.factorial(2 * n + 1) for n in range(12)][::-1])
"""Of (sin x)/x in powers of x^2, highest first: to 1e-19 up to pi/2."""

_compiled = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=False)


@_compiled
def _sine(x: float) -> float:
    square, value = x * x, _SINES[0]
    for n in range(1, _SINES.size):
        value = value * square + _SINES[n]
    return x * value


@_compiled
def _agm(x: float, y: float) -> float:
    """Return the arithmetic-geometric mean of two positive numbers."""
    for _ in range(40):
        if abs(x - y) <= 4.0 * _EPS * x:
            break
        x, y = 0.5 * (x + y), math.sqrt(x * y)
    return 0.5 * (x + y)


@_compiled
def _state(can, series, well, phi, below, out, count, work):  # type: ignore[no-untyped-def]
    """Fill rows of `out` with b, spin, sin phi and g/(r - phi) at `count` nutations."""
    a, c, h, residue, balance = can[0], can[1], can[2], can[6], can[7]
    r, b_r, s_r, B, S_r, C_r, short = well
    terms = series.shape[1]
    for j in range(count):
        for row in range(5):
            work[row, j] = series[row, terms - 1]
    for n in range(terms - 2, -1, -1):
        p0, p1, p2, p3, p4 = series[0, n], series[1, n], series[2, n], series[3, n], series[4, n]
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
        S, half = _sine(x), _sine(0.5 * down)
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
        lean = 2.0 * half * balance * _sine(short + 0.5 * down)
        out[0, j] = b
        out[1, j] = s_r + ds
        out[2, j] = S
        out[3, j] = (lean - kinetic) / down


@_compiled
def _noise(can, well, phi, below, b, s):  # type: ignore[no-untyped-def]
    """Return the round-off of g at one nutation, as `effective_potential.energy_noise` has it."""
    a, c, h, balance = can[0], can[1], can[2], can[7]
    r, b_r, s_r, _, S_r, C_r, short = well
    b_size = abs(b_r) + abs(s_r) * min(r, phi) * r
    s_size = abs(s_r) + abs(b_r) * (1.0 + abs(math.log(phi / r)))
    sums = 0.0
    for top in range(2):
        S, C = (S_r, C_r) if top else (_sine(phi), math.cos(phi))
        b_at, s_at = (abs(b_r), abs(s_r)) if top else (abs(b), abs(s))
        q, w = b_at / S, s_at + b_at / (1.0 + C)
        dq = (b_at + b_size) / S
        dw = w + s_size + b_size
        sums += a * q * dq + c * w * dw + (w + h * q) * (dw + h * dq)
    lean = balance * abs(short + 0.5 * below)
    return 2.8 * _EPS * (sums * min(1.0, below / phi) + lean * below)


@_compiled
def _clock(low, high, swing, K, K1, complementary, nodes, phi, rise, gap):  # type: ignore[no-untyped-def]
    """Fill the nutations of the nodes, and their distances from phi_min and phi_max."""
    q = math.exp(-math.pi * K / K1)
    z2, z3, z4 = 1.0, 1.0, 1.0
    sign = 1.0
    for n in range(1, 4):
        sign = -sign
        weight, square = q ** (n * (n + 1)), q ** (n * n)
        z2 += weight
        z3 += 2.0 * square
        z4 += 2.0 * sign * square
    s_factor, c_factor, d_factor = (z3 / z4) ** 2, (z2 / z4) ** 2, (z2 / z3) ** 2
    w1, w2, w3, w4, w6, w9 = q * q, q**6, q**12, q**4, q, q**9
    for j in range((nodes + 1) // 2):
        e = math.exp(math.pi * K / (2.0 * K1) * (j + 0.5) / nodes)
        d = 1.0 / e
        e2, d2 = e * e, d * d
        e3, d3 = e * e2, d * d2
        e5, d5 = e3 * e2, d3 * d2
        e7, d7 = e5 * e2, d5 * d2
        e4, d4 = e2 * e2, d2 * d2
        e6, d6 = e4 * e2, d4 * d2
        t1 = 0.5 * (e - d - w1 * (e3 - d3) + w2 * (e5 - d5) - w3 * (e7 - d7))
        t2 = 0.5 * (e + d + w1 * (e3 + d3) + w2 * (e5 + d5) + w3 * (e7 + d7))
        u1, u2, u3 = w6 * (e2 + d2), w4 * (e4 + d4), w9 * (e6 + d6)
        t3, t4 = 1.0 + u1 + u2 + u3, 1.0 - u1 + u2 - u3
        sn2, cn2 = s_factor * (t1 / t2) ** 2, c_factor * (t4 / t2) ** 2
        dn2 = d_factor * (t3 / t2) ** 2
        for mirrored in range(2):
            i = nodes - 1 - j if mirrored else j
            s = cn2 / dn2 if mirrored else sn2
            k = complementary * sn2 / dn2 if mirrored else cn2
            denominator = swing * k + 2.0 * low
            rise[i] = 2.0 * low * swing * s / denominator
            gap[i] = swing * (high + low) * k / denominator
            phi[i] = low + rise[i] if rise[i] < gap[i] else high - gap[i]


@_compiled
def _one(can, basis, phi0, psi_dot, theta_dot, waves, space, result):  # type: ignore[no-untyped-def]
    """Fill period, turn, rotation, phi_min, phi_max, peak rate; return whether they are sure."""
    work, out, quotients, phi, below, rise = space
    a, c, h, k, a_p, c_p, _, balance, near_balance, rest = can
    S_r, C_r = math.sin(phi0), math.cos(phi0)
    b_r, s_r = S_r * S_r * psi_dot, psi_dot + theta_dot
    short = (near_balance - phi0) + rest
    # at rest the can falls where the force is below its round-off
    T = S_r / (1.0 + C_r)
    q = b_r / S_r
    bend = a_p * C_r + c_p * T * S_r + h * T * (1.0 + 2.0 * C_r)
    kinetic_force = q * (q * bend - (c_p * S_r + h * C_r) * s_r) / S_r
    force = kinetic_force + h * S_r - C_r
    size = 1.0 + (q * q * (1.0 + a_p) + abs(q * s_r)) / S_r
    if not force < -64.0 * _EPS * size:
        return _LEFT
    whole = kinetic_force - balance * math.sin(short)
    if abs(whole) < 1e-3 * (s_r * s_r + q * q):
        return _LEFT
    # the constants of the branch, and its divided differences at the release
    terms = min(basis.shape[1], int(6 + 40.0 / math.log(math.pi / phi0)))
    b1 = s1 = b2 = s2 = 0.0
    for n in range(terms - 1, -1, -1):
        b1 = b1 * phi0 + basis[0, n]
        s1 = s1 * phi0 + basis[1, n]
        b2 = b2 * phi0 + basis[2, n]
        s2 = s2 * phi0 + basis[3, n]
    B = b_r * s1 - s_r * b1
    branch = s_r * b2 - b_r * s2
    if not abs(B) > 1e-150:
        return _LEFT
    carry_b = carry_s = 0.0
    for n in range(terms - 1, -1, -1):
        part_b = branch * basis[0, n] + B * basis[2, n]
        part_s = branch * basis[1, n] + B * basis[3, n]
        quotients[0, n], quotients[1, n], quotients[4, n] = basis[0, n], basis[1, n], part_b
        quotients[2, n], quotients[3, n] = carry_b, carry_s
        carry_b = part_b + phi0 * carry_b
        carry_s = part_s + phi0 * carry_s
    series = quotients[:, :terms]
    well = (phi0, b_r, s_r, B, S_r, C_r, short)
    low, fall = _lowest(can, series, well, work, out, phi, below)
    if not low > 0.0 or fall < 0.1 * phi0:
        return _LEFT
    swing = fall
    if swing <= 1e-6 * phi0:
        return _LEFT
    # the fourth root of the quartic, from the slope and its change at the release
    aside = min(1e-3 * phi0, 0.5 * swing)
    below[0], below[1] = 1e-20 * aside, aside
    phi[0], phi[1] = phi0 - below[0], phi0 - below[1]
    _state(can, series, well, phi, below, out, 2, work)
    near, far = out[3, 0], out[3, 1]
    drop = far - near
    reach = near * aside / drop if drop > 0.0 else math.inf
    reach = min(max(reach, 4.0 * _EPS * phi0), math.pi - phi0)
    fourth = phi0 + reach
    complementary = 2.0 * low * (fourth - phi0) / ((fourth - low) * (phi0 + low))
    if not complementary <= 0.5:
        return _LEFT
    K = 0.5 * math.pi / _agm(1.0, math.sqrt(complementary))
    K1 = 0.5 * math.pi / _agm(1.0, math.sqrt(1.0 - complementary))
    strip = min(math.atan(math.sqrt((phi0 + low) / swing)), K1)
    nodes = 8 * int(math.ceil((38.0 * K / (2.0 * math.pi * strip) + 4.0) / 8.0))
    if nodes > _NODES:
        return _LEFT
    _clock(low, phi0, swing, K, K1, complementary, nodes, phi, rise, below)
    _state(can, series, well, phi, below, out, nodes, work)
    scale = 2.0 / math.sqrt((fourth - low) * (phi0 + low))
    factor = math.sqrt(0.5 * (a_p + 1.0)) * scale
    beyond = fourth - phi0
    period = turn = total = 0.0
    smallest, least, best, peak = math.inf, 0, -1, 0.0
    for j in range(nodes):
        S = out[2, j]
        room = S * S * (out[3, j] / rise[j]) / ((phi[j] + low) * (beyond + below[j]))
        if not room > 0.0:
            return _LEFT
        work[0, j] = room
        time = factor * S / math.sqrt(room)
        rate = out[0, j] / (S * S)
        work[1, j], work[2, j], work[3, j] = time, rate * time, out[1, j] * time
        if room < smallest:
            smallest, least = room, j
        if abs(rate) > abs(peak):
            best, peak = j, rate
        period += work[1, j]
        turn += work[2, j]
        total += work[3, j]
    if not _positive(work[0], nodes, waves[nodes // 8], smallest):
        return _LEFT
    for j in (0, least):
        lost = _noise(can, well, phi[j], below[j], out[0, j], out[1, j])
        if lost > 1e-10 * abs(out[3, j] * below[j]):
            return _LEFT
    if _rough(work, nodes, waves[nodes // 8]):
        return _LEFT
    weight = 2.0 * K / nodes
    result[0], result[1], result[2] = weight * period, weight * turn, weight * (total - turn)
    result[3], result[4] = low, phi0
    # the peak rate: at an end, or between two nodes
    first = phi[best - 1] if best > 0 else low
    last = phi[best + 1] if best < nodes - 1 else phi0
    below[0], phi[0] = swing, low
    _state(can, series, well, phi, below, out, 1, work)
    bottom = out[0, 0] / out[2, 0] ** 2
    if abs(bottom) >= abs(peak):
        result[5] = bottom
    elif abs(psi_dot) >= abs(peak):
        result[5] = psi_dot
    else:
        result[5] = _peak(can, series, well, first, last, peak, work, out, phi, below)
    return _DONE


@_compiled
def _energy(can, series, well, at, work, out, phi, below):  # type: ignore[no-untyped-def]
    """Return g/(r - phi) times sin^2 phi at one nutation, which is all but linear in sin^2 phi."""
    phi[0], below[0] = at, well[0] - at
    _state(can, series, well, phi, below, out, 1, work)
    return out[3, 0] * out[2, 0] ** 2


@_compiled
def _lowest(can, series, well, work, out, phi, below):  # type: ignore[no-untyped-def]
    """Return phi_min and its distance from the release; zero where it is not found."""
    r, B = well[0], abs(well[3])
    # from where precession alone would take all the energy
    left = min(0.5 * r, B)
    f_left = _energy(can, series, well, left, work, out, phi, below)
    for _ in range(60):
        if not f_left > 0.0:
            break
        left /= 8.0
        f_left = _energy(can, series, well, left, work, out, phi, below)
    # places between, all at once: the first below the release at which g is not positive
    places = 7
    for j in range(places):
        phi[j] = r * (left / r) ** ((j + 1.0) / places)
        below[j] = r - phi[j]
    _state(can, series, well, phi, below, out, places, work)
    right, f_right = 0.0, 0.0
    for j in range(places):
        value = out[3, j] * out[2, j] ** 2
        if value <= 0.0:
            left, f_left = phi[j], value
            break
        right, f_right = phi[j], value
    if right == 0.0:
        return 0.0, 0.0
    # secant in phi^2 through the last two places, kept inside the bracket
    before, f_before, at, f_at = left, f_left, right, f_right
    if abs(f_left) < abs(f_right):
        before, f_before, at, f_at = right, f_right, left, f_left
    for _ in range(80):
        square = at * at
        if f_at != f_before:
            square -= f_at * (square - before * before) / (f_at - f_before)
        inside = left * left < square < right * right
        next_ = math.sqrt(square) if inside else math.sqrt(left * right)
        moved = abs(next_ - at)
        if moved <= _EPS * at:
            break
        before, f_before = at, f_at
        at = next_
        f_at = _energy(can, series, well, at, work, out, phi, below)
        if f_at == 0.0:
            break
        if f_at > 0.0:
            right = at
        else:
            left = at
        if right - left <= _EPS * right:
            break
    return at, r - at


@_compiled
def _positive(room, nodes, waves, smallest):  # type: ignore[no-untyped-def]
    """Return whether g is shown to be positive between the nodes, as `brackets.stays_positive`."""
    bend = largest = last = 0.0
    for m in range(nodes):
        value = 0.0
        for j in range(nodes):
            value += waves[m, j] * room[j]
        value = abs(value)
        bend += m * m * value
        largest = max(largest, value)
        if m >= nodes - 3:
            last = max(last, value)
    tail = 8.0 * last + nodes * _EPS * largest
    return smallest > tail + (math.pi / (nodes - 1)) ** 2 / 8.0 * bend


@_compiled
def _rough(work, nodes, waves):  # type: ignore[no-untyped-def]
    """Return whether the two highest harmonics of an integrand have not yet decayed."""
    for row in range(1, 4):
        size = high = higher = 0.0
        for j in range(nodes):
            size += abs(work[row, j])
            high += waves[nodes - 2, j] * work[row, j]
            higher += waves[nodes - 1, j] * work[row, j]
        # waves have the weight 2/n of a coefficient
        if max(abs(high), abs(higher)) * 0.5 * nodes > 3e-9 * size:
            return True
    return False


@_compiled
def _peak(can, series, well, first, last, peak, work, out, phi, below):  # type: ignore[no-untyped-def]
    """Return the precession rate of largest magnitude between two nutations around a node."""
    r = well[0]
    for _ in range(24):
        for j in range(9):
            phi[j] = first + (last - first) * j / 8.0
            below[j] = max(r - phi[j], 1e-20 * r)
        _state(can, series, well, phi, below, out, 9, work)
        best = 0
        for j in range(9):
            rate = out[0, j] / out[2, j] ** 2
            if abs(rate) >= abs(peak):
                best, peak = j, rate
        first, last = phi[max(best - 1, 0)], phi[min(best + 1, 8)]
        if last - first <= 1e-6 * last:
            break
    return peak


@_compiled
def _all(can, basis, phi, psi_dot, theta_dot, waves, results, done):  # type: ignore[no-untyped-def]
    """Solve releases one after another."""
    space = (
        np.empty((6, _NODES)),
        np.empty((4, _NODES)),
        np.empty((5, basis.shape[1])),
        np.empty(_NODES),
        np.empty(_NODES),
        np.empty(_NODES),
    )
    for i in range(phi.size):
        done[i] = _one(
            can, basis, phi[i], psi_dot[i], theta_dot[i], waves, space, results[i]
        )
