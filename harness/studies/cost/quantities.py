"""The errors that the study names: what they are, in which unit, and the axes that show them."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """One error.

    Parameters
    ----------
    key : str
        As in the records, with the unit as the suffix.
    title, label : str
        Of the panel and of its axis.
    meaning : str
    low, high : float
        Ends of the axis, the same for all scenes.
    """

    key: str
    title: str
    label: str
    meaning: str
    low: float
    high: float


TURN = Quantity(
    key="turn_deg",
    title="Angle of turn",
    label="error of the turn [deg]",
    meaning="First angle of turn, engine minus truth; empty where the record cannot count turns.",
    low=1e-8,
    high=1e3,
)

QUANTITIES = (
    TURN,
    Quantity(
        key="phi_rms_rad",
        title="Nutation",
        label="phi, rms [rad]",
        meaning="Root mean square error of phi over the run.",
        low=1e-12,
        high=1.0,
    ),
    Quantity(
        key="phi_max_rad",
        title="Nutation, at worst",
        label="phi, largest [rad]",
        meaning="Largest error of phi over the run.",
        low=1e-12,
        high=1.0,
    ),
    Quantity(
        key="bounce_time_s",
        title="Time of the bounce",
        label="time of the bounce [s]",
        meaning="Time of the first minimum of phi, engine minus truth.",
        low=1e-12,
        high=1.0,
    ),
    Quantity(
        key="contact_locus_rms_m",
        title="Contact locus",
        label="contact locus, rms [m]",
        meaning="Distance of the contact points at the same instant, rms; not of the reference.",
        low=1e-9,
        high=1e-1,
    ),
    Quantity(
        key="peak_friction_ratio",
        title="Peak friction ratio",
        label="peak |F|/N [1]",
        meaning="Largest |F|/N of the first bounce, engine minus truth.",
        low=1e-10,
        high=1e2,
    ),
    Quantity(
        key="energy_drift",
        title="Energy",
        label="energy drift over m g R [1]",
        meaning="Largest departure of the energy from its first value, over m g R.",
        low=1e-12,
        high=1e2,
    ),
    Quantity(
        key="rotation_rms_deg",
        title="Orientation",
        label="rotation, rms [deg]",
        meaning="Angle between the true and the engine's orientation, root mean square.",
        low=1e-8,
        high=1e3,
    ),
)

COST_LOW, COST_HIGH = 1e-3, 1e3
"""Processor seconds per simulated second: ends of the axis of costs, the same for all scenes."""
