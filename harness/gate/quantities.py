"""The quantities that are held against accepted ones; of each, smaller is better.

A floor is what round-off alone makes of a quantity that is zero in exact arithmetic: some 1e6 steps
that each add 1e-16 of its scale, in no order. Below its floor nothing counts as a change.
"""

from dataclasses import dataclass
from enum import Enum


class Kind(Enum):
    """What a quantity speaks of, which decides when it is judged."""

    ERROR = "distance from the exact motion"
    CONTACT = "quality of the contact"
    COST = "work that does not depend on the machine"
    TIME = "time on this machine"


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """A column of the table of results, and how it is held against an accepted one."""

    column: str
    words: str
    unit: str
    kind: Kind
    floor: float


def _error(column: str, words: str, unit: str, floor: float) -> Quantity:
    return Quantity(column=column, words=words, unit=unit, kind=Kind.ERROR, floor=floor)


def _contact(column: str, words: str, unit: str, floor: float) -> Quantity:
    return Quantity(column=column, words=words, unit=unit, kind=Kind.CONTACT, floor=floor)


_RAD = 1e-12
"""rad: the comparison of orders, too, takes a smaller error for a sum of roundings."""

_DEG = 1e-10
"""deg: the same of a difference of two angles of some hundred degrees."""

_M = 1e-13
"""m: the same of a locus within some radii of 0.04 m."""

_TOUCH_M = 1e-9
"""m: a nanometre; contacts rest micrometres deep, and round-off of a position is 1e-17."""

_SHARE = 1e-4
"""Of the time: a single sample of the short records; one that flips is no change of an engine."""

_ROWS = 16.0
"""Rows of one step with four points and a pyramid each: the last step may fall on either side."""

QUANTITIES = (
    _error("angle_of_turn_error_deg", "error of the angle of turn", "deg", _DEG),
    _error("bounce_time_error_s", "error of the time of the bounce", "s", 1e-13),
    _error("peak_friction_ratio_error", "error of the peak friction ratio", "", 1e-10),
    _error("phi_rms_rad", "rms error of phi", "rad", _RAD),
    _error("phi_max_rad", "largest error of phi", "rad", _RAD),
    _error("psi_rms_rad", "rms error of psi", "rad", 10.0 * _RAD),  # psi runs through many turns
    _error("theta_rms_rad", "rms error of theta", "rad", 10.0 * _RAD),  # and so does theta
    _error("rotation_rms_rad", "rms error of the orientation", "rad", 10.0 * _RAD),
    _error("contact_locus_rms_m", "rms error of the contact locus", "m", _M),
    _error("contact_locus_hausdorff_m", "distance of the contact loci as curves", "m", _M),
    _contact("energy_drift", "energy drift", "m g R", _RAD),
    _contact("max_penetration_m", "deepest penetration", "m", _TOUCH_M),
    _contact("max_slip_m_s", "fastest slip", "m/s", _TOUCH_M),  # a nanometre a second
    _contact("lift_off_fraction", "time without contact", "of the time", _SHARE),
    _contact("multi_contact_fraction", "time with several contacts", "of the time", _SHARE),
    Quantity(column="steps", words="steps", unit="", kind=Kind.COST, floor=1.0),  # the last one
    Quantity(
        column="constraint_rows", words="constraint rows", unit="", kind=Kind.COST, floor=_ROWS
    ),
    Quantity(column="wall_s", words="time by the clock", unit="s", kind=Kind.TIME, floor=0.0),
    Quantity(column="cpu_s", words="time of the processor", unit="s", kind=Kind.TIME, floor=0.0),
)
"""In the order in which they are named where several have changed."""

BY_COLUMN = {quantity.column: quantity for quantity in QUANTITIES}
