"""Many releases of many cans at once, by the exact bounce, in SI units.

Beside `harness.engines.reference` the one file of the harness that imports `reference` to run it:
a formula for whole arrays of releases has no trajectory and is no engine.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.core.simulation import Outcome
from harness.engines.base import Floats
from reference import Outcome as Ending
from reference import exact_bounces
from reference.integrable.frobenius import CanConstants, frobenius_series, horner, terms_needed
from reference.integrable.turning_points import OUTCOMES

_SENTENCES = {Ending.FINISHED: Outcome.FINISHED.value, Ending.OVERTURNED: Outcome.OVERTURNED.value}

SENTENCES = tuple(
    _SENTENCES.get(ending, f"{Outcome.NO_SOLUTION.value} ({ending.value})") for ending in OUTCOMES
)
"""How a release can end, by its code."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Releases:
    """Releases of cans, SI units and radians; each of shape () or (n,).

    Those of the can, `a`, `c`, `h` and `radius`, and `gravity` may be one number for all, which is
    fastest.
    """

    a: Floats
    c: Floats
    h: Floats
    radius: Floats
    gravity: Floats
    phi: Floats
    phi_dot: Floats
    psi_dot: Floats
    theta_dot: Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Batch:
    """The first bounces of n releases.

    Parameters
    ----------
    code : ndarray of int, shape (n,)
        Index into `SENTENCES`.
    numbers : mapping of str to ndarray, shape (n,)
        `period` (s), `angle_of_turn`, `rotation_turn`, `phi_min` (rad), `peak_psi_dot` (rad/s);
        NaN where there is no bounce.
    """

    code: NDArray[np.int8]
    numbers: Mapping[str, Floats]

    @property
    def bounced(self) -> NDArray[np.bool_]:
        """Where there is a bounce, shape (n,)."""
        return np.asarray(self.code == OUTCOMES.index(Ending.FINISHED), dtype=np.bool_)


def bounces_of(releases: Releases) -> Batch:
    """Solve releases exactly.

    Raises
    ------
    ValueError
        If a can or a release is none, or gravity is not positive.
    """
    r = releases
    if not (np.asarray(r.gravity) > 0.0).all():
        raise ValueError("`gravity` must be positive: without it no can rocks")
    time = np.sqrt(np.asarray(r.radius) / r.gravity)
    cycles = exact_bounces(
        a=r.a,
        c=r.c,
        h=r.h,
        phi=r.phi,
        phi_dot=r.phi_dot * time,
        psi_dot=r.psi_dot * time,
        theta_dot=r.theta_dot * time,
    )
    none = ~cycles.bounced
    numbers = {
        "period": cycles.period * time,
        "angle_of_turn": cycles.angle_of_turn,
        "rotation_turn": cycles.rotation_turn,
        "phi_min": cycles.phi_min,
        "peak_psi_dot": cycles.peak_psi_dot / time,
    }
    return Batch(
        code=cycles.code,
        numbers={name: np.where(none, np.nan, values) for name, values in numbers.items()},
    )


def epsilon_of(releases: Releases) -> Floats:
    """Return B_-2 squared of releases, rates in sqrt(g/R), shape (n,).

    Equation (eq01:epsilon_zeta); B_-2 is the first integral B of `reference.integrable.frobenius`,
    exactly.
    """
    r = releases
    time = np.sqrt(np.asarray(r.radius) / r.gravity)
    phi, psi_dot, theta_dot = np.broadcast_arrays(
        np.asarray(r.phi), r.psi_dot * time, r.theta_dot * time
    )
    can = CanConstants(a=np.asarray(r.a), c=np.asarray(r.c), h=np.asarray(r.h))
    if can.a.ndim == can.c.ndim == can.h.ndim == 0:
        can = CanConstants(a=can.a.reshape(1), c=can.c.reshape(1), h=can.h.reshape(1))
    else:
        a, c, h = np.broadcast_arrays(can.a, can.c, can.h)
        can = CanConstants(a=a, c=c, h=h)
    series = frobenius_series(can, terms_needed(float(phi.max())))
    b, spin = np.sin(phi) ** 2 * psi_dot, psi_dot + theta_dot
    B = b * horner(series.s1, phi) - spin * horner(series.b1, phi)
    return np.asarray(B * B, dtype=np.float64)
