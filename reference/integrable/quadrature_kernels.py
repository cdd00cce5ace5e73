"""The midpoint rule on the elliptic clock of one release, compiled to machine code.

The mathematics of `reference.integrable.elliptic` and `reference.integrable.quadrature` in scalars.

Needs numba (`reference.numerics.compiled`).
"""

import math

from reference.integrable.brackets import LAST
from reference.integrable.brackets import TAIL as OMITTED
from reference.integrable.potential_kernels import EPS, Space
from reference.integrable.quadrature import TAIL
from reference.numerics.compiled import jit
from reference.problem.states import Floats


@jit
def arithmetic_geometric_mean(x: float, y: float) -> float:
    """Return the arithmetic-geometric mean of two positive numbers."""
    for _ in range(40):
        if abs(x - y) <= 4.0 * EPS * x:
            break
        x, y = 0.5 * (x + y), math.sqrt(x * y)
    return 0.5 * (x + y)


@jit
def place_nodes(
    space: Space,
    ends: tuple[float, float, float],
    periods: tuple[float, float, float],
    nodes: int,
) -> None:
    """Fill the nutations of the nodes, and their distances from phi_min and phi_max.

    The ends are phi_min, phi_max and their distance; the periods K, K' and k'^2.
    """
    low, high, swing = ends
    K, K1, complementary = periods
    phi, rise, gap = space.phi, space.rise, space.below
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


@jit
def stays_positive(work: Floats, nodes: int, waves: Floats, smallest: float) -> bool:
    """Return whether g is shown to be positive between the nodes, as `brackets.stays_positive`."""
    for m in range(nodes):
        work[4, m] = 0.0
    for j in range(nodes):
        room = work[0, j]
        for m in range(nodes):
            work[4, m] += waves[j, m] * room
    bend = largest = last = 0.0
    for m in range(nodes):
        value = abs(work[4, m])
        bend += m * m * value
        largest = max(largest, value)
        if m >= nodes - LAST:
            last = max(last, value)
    tail = OMITTED * last + nodes * EPS * largest
    return bool(smallest > tail + (math.pi / (nodes - 1)) ** 2 / 8.0 * bend)


@jit
def unresolved(work: Floats, nodes: int, waves: Floats) -> bool:
    """Return whether the two highest harmonics of an integrand have not yet decayed."""
    for row in range(1, 4):
        size = high = higher = 0.0
        for j in range(nodes):
            size += abs(work[row, j])
            high += waves[j, nodes - 2] * work[row, j]
            higher += waves[j, nodes - 1] * work[row, j]
        # waves have the weight 2/n of a coefficient
        if max(abs(high), abs(higher)) * 0.5 * nodes > TAIL * size:
            return True
    return False
