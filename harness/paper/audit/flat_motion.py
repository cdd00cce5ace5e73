"""Psi and Theta near the flat state as numbers, to sixty digits: series by recurrence.

Independent of `flat_series`: numbers from the start, any order, no symbols.
"""

from dataclasses import dataclass
from functools import cache

import mpmath as mp

from harness.paper.audit.paper_can import PHI, PSI_DOT, THETA_DOT, a_p, c_p, h, k

ORDER = 40
"""Powers of phi kept: at phi <= 0.01 the next is below 10^-80."""
with mp.workdps(80):
    gamma, beta = 2 + k, k * h


CONSTANTS = mp.mpf("0.75"), mp.mpf(1)
"""B_0 and B_-2 of the motion along which remainders are measured; exact as binary numbers."""
RATES = mp.mpf(1), mp.mpf("0.3125")
"""Psi and Theta at which constants are compared; exact as binary numbers."""
TINY = (1e-5, 1e-8)
"""Nutations between which the error of a constant is observed."""
EXACT = "the exact constants by the Wronskian, at fixed Psi and Theta"


@dataclass(frozen=True, slots=True, kw_only=True)
class Flat:
    """Values and slopes of the two solutions at one nutation."""

    regular: mp.mpf
    regular_slope: mp.mpf
    singular: mp.mpf
    singular_slope: mp.mpf


@cache
def _coefficients(digits: int) -> tuple[list[mp.mpf], list[mp.mpf], mp.mpf]:
    """Return p_n, q_n and the strength of the logarithm."""
    with mp.workdps(digits):
        cot = [mp.mpf(0)] * (ORDER + 3)  # of phi cot phi
        for j in range(0, ORDER + 3, 2):
            sign = (-1) ** (j // 2)
            cot[j] = sign * mp.mpf(2) ** j * mp.bernoulli(j) / mp.factorial(j)

        def rest(values: list[mp.mpf], n: int, start: int) -> mp.mpf:
            """Terms of phi^2 times eq01:frob_ode at the n-th power that earlier ones give."""
            total = -gamma * values[n - 2] if n > 1 else mp.mpf(0)
            for j in range(2, n + 1, 2):
                total += 3 * cot[j] * (n - j + start) * values[n - j]
            for j in range(0, n, 2):
                total -= beta * cot[j] * values[n - 1 - j]
            return total

        p = [mp.mpf(1)]
        for n in range(1, ORDER):
            p.append(-rest(p, n, 0) / (n * (n + 2)))
        q = [mp.mpf(1)]
        log = mp.mpf(0)
        for n in range(1, ORDER):
            left = rest(q, n, -2)
            power = n - 2
            if power == 0:
                log = -left / 2
                q.append(mp.mpf(0))
                continue
            if power > 0:
                left += log * (2 * power - 1) * p[power]
                left += log * 3 * sum(cot[j] * p[power - j] for j in range(0, power + 1, 2))
            q.append(-left / (power * (power + 2)))
        return p, q, log


def flat(phi: mp.mpf) -> Flat:
    """Return the two solutions at a nutation of at most about 0.01."""
    p, q, log = _coefficients(int(mp.mp.dps) + 10)
    regular = mp.polyval(p[::-1], phi)
    regular_slope = sum(n * x * phi ** (n - 1) for n, x in enumerate(p) if n)
    singular = sum(x * phi ** (n - 2) for n, x in enumerate(q)) + log * mp.log(phi) * regular
    singular_slope = (
        sum((n - 2) * x * phi ** (n - 3) for n, x in enumerate(q))
        + log * regular / phi
        + log * mp.log(phi) * regular_slope
    )
    return Flat(
        regular=regular,
        regular_slope=regular_slope,
        singular=singular,
        singular_slope=singular_slope,
    )


def rates(phi: mp.mpf, zero: mp.mpf, two: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
    """Return Psi and Theta at a nutation for constants B_0 and B_-2."""
    at = flat(phi)
    psi = zero * at.regular + two * at.singular
    slope = zero * at.regular_slope + two * at.singular_slope
    kc, sine, cosine = k * c_p, mp.sin(phi), mp.cos(phi)
    return psi, (slope * sine - ((kc - 2) * cosine - h * k * sine) * psi) / kc


def constants(phi: mp.mpf, psi: mp.mpf, theta: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
    """Return B_0 and B_-2 of a state."""
    at = flat(phi)
    slope = (k * c_p * theta + ((k * c_p - 2) * mp.cos(phi) - h * k * mp.sin(phi)) * psi) / mp.sin(
        phi
    )
    wronskian = at.regular * at.singular_slope - at.regular_slope * at.singular
    return (
        (psi * at.singular_slope - slope * at.singular) / wronskian,
        (at.regular * slope - at.regular_slope * psi) / wronskian,
    )


def drive(phi: mp.mpf, zero: mp.mpf, two: mp.mpf) -> mp.mpf:
    """Return what the rates add to (a_p + 1) phi'' in eq01:Phi."""
    psi, theta = rates(phi, zero, two)
    sine, cosine = mp.sin(phi), mp.cos(phi)
    square = (a_p - c_p) * sine * cosine - h * mp.cos(2 * phi)
    return square * psi**2 - (c_p * sine + h * cosine) * theta * psi


@cache
def exact_constants() -> tuple[mp.mpf, mp.mpf]:
    """Return B_0 and B_-2 of the paper's release."""
    with mp.workdps(30):
        return constants(PHI, PSI_DOT, THETA_DOT)
