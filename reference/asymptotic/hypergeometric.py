"""The second-order equation for the precession rate and its hypergeometric solution.

Eliminating Theta from the closed subsystem leaves (eq01:frob_ode), with gamma = 2 + k and beta = k
h,

    Psi'' + 3 cot(phi) Psi' - (gamma + beta cot(phi)) Psi = 0,

solved by (eq01:hyper_geom, its two terms)

    sin^(-3/2) (cot + i)^(-+r') (cot - i)^r F(r - 1/2 -+ r', r + 3/2 -+ r'; 1 -+ 2 r'; 1/2 - i
    cot/2),

r = sqrt(rho), r' its complex conjugate. The paper prints rho = (9 + 4 gamma + 4 i beta)/16, with
which it solves nothing; it must read rho = (9 - 4 gamma - 4 i beta)/16.

The package computes with `reference.integrable.frobenius`; this is the same function by another
road.
"""

import numpy as np

from reference.problem.can import Parameters

# Taylor steps reach this far towards the nearest singular point: 0.5^60 is below round-off.
REACH = 0.5
TERMS = 64


def hypergeometric_pair(parameters: Parameters, phi: float) -> tuple[complex, complex]:
    """Return the two terms of eq01:hyper_geom with C_3 = C_4 = 1, at 0 < phi <= pi/2."""
    rho = (9 - 4 * (2 + parameters.k) - 4j * parameters.k * parameters.h) / 16
    r = complex(np.sqrt(rho))
    cotangent = 1 / np.tan(phi)
    z = 0.5 - 0.5j * cotangent
    terms = []
    for sign in (-1, 1):
        q = sign * r.conjugate()
        factor = np.sin(phi) ** -1.5 * (cotangent + 1j) ** q * (cotangent - 1j) ** r
        terms.append(complex(factor * gauss(r - 0.5 + q, r + 1.5 + q, 1 + 2 * q, z)))
    return terms[0], terms[1]


def gauss(a: complex, b: complex, c: complex, z: complex) -> complex:
    """Gauss's function F(a, b; c; z) with complex arguments, away from the cut z > 1.

    Its power series near 0, continued by Taylor series of its differential equation along a
    straight line to 1/2 and from there to z.
    """
    at = 0.3 + 0j
    value, slope = _near_zero(a, b, c, at)
    for target in (0.5 + 0j, z):
        while at != target:
            room = REACH * min(abs(at), abs(1 - at))
            step = target - at
            if abs(step) > room:
                step *= room / abs(step)
            value, slope = _continued((a, b, c), at, (value, slope), step)
            at = target if abs(target - at) <= room else at + step
    return value


def _near_zero(a: complex, b: complex, c: complex, z: complex) -> tuple[complex, complex]:
    term, value, slope = 1 + 0j, 1 + 0j, 0j
    for n in range(TERMS):
        term *= (a + n) * (b + n) / ((c + n) * (n + 1))
        slope += (n + 1) * term * z**n
        value += term * z ** (n + 1)
    return value, slope


def _continued(
    abc: tuple[complex, complex, complex],
    at: complex,
    state: tuple[complex, complex],
    step: complex,
) -> tuple[complex, complex]:
    """Step by the Taylor series from z (1 - z) F'' + (c - (a + b + 1) z) F' = a b F."""
    a, b, c = abc
    f = list(state)
    q0, q1 = at * (1 - at), 1 - 2 * at
    p0, p1 = c - (a + b + 1) * at, -(a + b + 1)
    for n in range(TERMS):
        rest = (n + 1) * (q1 * n + p0) * f[n + 1] + (-n * (n - 1) + p1 * n - a * b) * f[n]
        f.append(-rest / (q0 * (n + 1) * (n + 2)))
    new = sum(f[n] * step**n for n in range(TERMS))
    new_slope = sum(n * f[n] * step ** (n - 1) for n in range(1, TERMS))
    return complex(new), complex(new_slope)
