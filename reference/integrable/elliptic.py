"""The elliptic substitution: a time in which the nutation is smooth at both ends of a bounce.

Between its extrema c = phi_min and b = phi_max the nutation is written phi(u), where

    dphi/du = g sqrt((phi - c)(phi + c)(b - phi)(a - phi)),      g = 2/sqrt((a - c)(b + c)),

so that phi(u) runs from c at u = 0 to b at u = K and is even about both. Near the bounce
phi = c cosh 2u, whatever c; near the top it waits as long as the neighbouring root a (the balanced
can) makes it wait. Everything else in the motion is then an analytic periodic function of u, for
which the midpoint rule converges exponentially, with a number of nodes that grows like log(b/c)
only.

phi = c (1 + r)/(1 - r), r = (b - c)/(b + c) sn^2(u), with the complementary parameter
k'^2 = 2 c (a - b)/((a - c)(b + c)). The elliptic functions are summed from theta series in the
complementary nome, where nothing cancels as k'^2 goes to 0.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import ellipj, ellipk, ellipkm1

from reference.problem.states import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class EllipticSubstitution:
    """The map u -> phi for n bounces.

    Attributes
    ----------
    low, high, fourth_root : ndarray, shape (n,)
        c, b, a with 0 < c < b < a.
    swing : ndarray, shape (n,)
        b - c, which has digits of its own where phi hardly moves.
    """

    low: Floats
    high: Floats
    swing: Floats
    fourth_root: Floats

    @property
    def complementary(self) -> Floats:
        """k'^2, shape (n,)."""
        a, b, c = self.fourth_root, self.high, self.low
        return 2 * c * (a - b) / ((a - c) * (b + c))

    @property
    def quarter(self) -> Floats:
        """The value of u at phi_max, K, shape (n,)."""
        return np.asarray(ellipkm1(self.complementary), dtype=float)

    @property
    def analyticity_strip(self) -> Floats:
        """Height above the real axis of u at which phi = 0, shape (n,)."""
        conjugate = ellipk(self.complementary)
        # sc^2(height) = (b + c)/(b - c) for the complementary parameter, about pi/4 in a hard
        # bounce
        ratio = np.sqrt((self.high + self.low) / self.swing)
        return np.asarray(np.minimum(np.arctan(ratio), conjugate), dtype=float)

    @property
    def scale(self) -> Floats:
        """The factor g of dphi/du, shape (n,)."""
        a, b, c = self.fourth_root, self.high, self.low
        return 2 / np.sqrt((a - c) * (b + c))

    def nutation(self, fraction: Floats) -> tuple[Floats, Floats, Floats]:
        """Nutation at u = fraction K.

        Parameters
        ----------
        fraction : ndarray, shape (m, 1) or (m, n)
            Inside [0, 1].

        Returns
        -------
        phi, phi - phi_min, phi_max - phi : ndarray, shape (m, n)
            Each to round-off of itself.
        """
        b, c, swing = self.high, self.low, self.swing
        sn2, cn2 = squared_sn_cn(fraction, self.complementary)
        denominator = swing * cn2 + 2 * c
        rise = 2 * c * swing * sn2 / denominator
        gap = swing * (b + c) * cn2 / denominator
        return np.where(rise < gap, c + rise, b - gap), rise, gap


def squared_sn_cn(fraction: Floats, complementary: Floats) -> tuple[Floats, Floats]:
    """sn^2 and cn^2 at u = fraction K(k), for the complementary parameter k'^2.

    Parameters
    ----------
    fraction : ndarray, shape (m, 1) or (m, n)
    complementary : ndarray, shape (n,)

    Returns
    -------
    sn^2, cn^2 : ndarray, shape (m, n)
        Each to relative round-off.
    """
    near = np.minimum(fraction, 1 - fraction)
    sn2, cn2, dn2 = _lower_half(near, complementary)
    # reflected about K/2: sn(K - x) = cn/dn, cn(K - x) = k' sn/dn
    lower = fraction <= 0.5  # noqa: PLR2004 - the middle
    return (
        np.where(lower, sn2, cn2 / dn2),
        np.where(lower, cn2, complementary * sn2 / dn2),
    )


def _lower_half(fraction: Floats, complementary: Floats) -> tuple[Floats, Floats, Floats]:
    """sn^2, cn^2, dn^2 at u = fraction K with fraction at most 1/2."""
    shape = np.broadcast_shapes(fraction.shape, complementary.shape)
    out = tuple(np.empty(shape) for _ in range(3))
    where = np.broadcast_to(fraction, shape)
    deep = complementary <= 0.5  # noqa: PLR2004 - where the two nomes are equal
    for chosen, rule in ((deep, _complementary_theta), (~deep, _plain)):
        if chosen.any():
            for target, value in zip(
                out, rule(where[:, chosen], complementary[chosen]), strict=True
            ):
                target[:, chosen] = value
    return out[0], out[1], out[2]


def _plain(fraction: Floats, complementary: Floats) -> tuple[Floats, Floats, Floats]:
    K = ellipkm1(complementary)
    sn, cn, dn, _ = ellipj(fraction * K, 1 - complementary)
    return sn**2, cn**2, dn**2


def _complementary_theta(fraction: Floats, complementary: Floats) -> tuple[Floats, Floats, Floats]:
    """Theta series in q' = exp(-pi K/K') <= exp(-pi).

    With v = pi u/(2 K') and u <= K/2 the terms fall like q'^(n^2 - n/2): four are enough.
    """
    K, K1 = ellipkm1(complementary), ellipk(complementary)
    q = np.exp(-np.pi * K / K1)
    v = (np.pi * K / (2 * K1)) * fraction
    e = np.exp(v)
    up, down = e * e, 1 / (e * e)
    # theta_1/i and theta_2 without their common factor; theta_3, theta_4
    t1, t2 = (e - 1 / e) / 2, (e + 1 / e) / 2
    t3, t4 = np.ones_like(v), np.ones_like(v)
    z2, z3, z4 = np.ones_like(q), np.ones_like(q), np.ones_like(q)
    odd_up, odd_down = e, 1 / e
    even_up, even_down = np.ones_like(v), np.ones_like(v)
    for n in (1, 2, 3):
        odd_up, odd_down = odd_up * up, odd_down * down
        even_up, even_down = even_up * up, even_down * down
        sign = (-1.0) ** n
        weight = q ** (n * (n + 1))
        t1 += sign * weight * (odd_up - odd_down) / 2
        t2 += weight * (odd_up + odd_down) / 2
        square = q ** (n * n)
        t3 += square * (even_up + even_down)
        t4 += sign * square * (even_up + even_down)
        z2 += weight
        z3 += 2 * square
        z4 += 2 * sign * square
    return (
        (z3 / z4 * t1 / t2) ** 2,
        (z2 / z4 * t4 / t2) ** 2,
        (z2 / z3 * t3 / t2) ** 2,
    )
