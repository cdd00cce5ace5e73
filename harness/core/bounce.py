"""The numbers of a bounce, in SI units, of an engine's motion or of the exact one."""

from dataclasses import dataclass

PROMINENCE = 0.01
"""Share of the largest phi by which an extremum of phi must stand out: a ripple is no bounce."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounce:
    """One bounce: from a maximum of phi through a minimum to the next maximum.

    Parameters
    ----------
    start, time, end : float
        Of the maximum before, of the minimum and of the maximum after, s. A release that falls
        counts as the maximum before.
    phi_min : float
        rad.
    angle_of_turn, rotation_turn : float
        Signed change of psi, and of theta, from the maximum before to the one after, rad.
    peak_psi_dot : float
        Precession rate of largest magnitude, with its sign, rad/s.
    peak_friction_ratio : float
        Largest |F|/N, dimensionless; infinite where the plane would have to pull, or does not
        push but holds the rim: friction without limit does not vanish with the push.
    resolved : bool
        False if the record is too coarse to tell how often psi went round in this bounce.
    """

    start: float
    time: float
    end: float
    phi_min: float
    angle_of_turn: float
    rotation_turn: float
    peak_psi_dot: float
    peak_friction_ratio: float
    resolved: bool = True
