"""What a sweep may ask of each scene: a column each, all of the first bounce.

What was found of consecutive scenes of a sweep.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from harness.sweep.parameters import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepQuantity:
    """A number of a bounce.

    Parameters
    ----------
    name : str
        Of its column, unit last.
    label : str
        Of an axis, with the unit in brackets.
    meaning : str
        One sentence.
    source : str
        "exact": the exact bounce has it, as a formula for many releases at once; "run": only a
        whole motion has it; "error": an engine's value minus the exact one.
    """

    name: str
    label: str
    meaning: str
    source: Literal["exact", "run", "error"] = "exact"


_ALL = (
    SweepQuantity(
        name="angle_of_turn_deg",
        label="angle of turn [deg]",
        meaning="Signed change of psi from the maximum of phi before the bounce to the one after.",
    ),
    SweepQuantity(
        name="rotation_turn_deg",
        label="turn of theta [deg]",
        meaning="Signed change of theta between the same two.",
    ),
    SweepQuantity(name="period_s", label="period [s]", meaning="Time between the same two."),
    SweepQuantity(
        name="phi_min_rad", label="least phi [rad]", meaning="Least nutation, in the bounce."
    ),
    SweepQuantity(
        name="peak_psi_dot_rad_s",
        label="peak psi' [rad/s]",
        meaning="Precession rate of largest magnitude in the bounce, with its sign.",
    ),
    SweepQuantity(
        name="epsilon",
        label="epsilon",
        meaning="The paper's small parameter, B_-2 squared with rates in sqrt(g/R), of the "
        "release: its square root measures how far the can is from falling flat.",
    ),
    SweepQuantity(
        name="peak_friction_ratio",
        label="peak |F|/N",
        meaning="Largest |F|/N between the two maxima.",
        source="run",
    ),
    SweepQuantity(
        name="energy_drift",
        label="change of energy [m g R]",
        meaning="Largest change of energy over the whole motion, over m g R.",
        source="run",
    ),
    SweepQuantity(name="steps", label="steps", meaning="Steps that the run took.", source="run"),
    SweepQuantity(
        name="angle_of_turn_error_deg",
        label="error of the angle of turn [deg]",
        meaning="The engine's angle of turn minus the exact one.",
        source="error",
    ),
    SweepQuantity(
        name="period_error_s",
        label="error of the period [s]",
        meaning="The engine's period minus the exact one.",
        source="error",
    ),
    SweepQuantity(
        name="phi_min_error_rad",
        label="error of the least phi [rad]",
        meaning="The engine's least nutation minus the exact one.",
        source="error",
    ),
)

QUANTITIES: Mapping[str, SweepQuantity] = MappingProxyType({known.name: known for known in _ALL})
"""What may be asked, by name."""

DEFAULT = (
    "angle_of_turn_deg",
    "rotation_turn_deg",
    "period_s",
    "phi_min_rad",
    "peak_psi_dot_rad_s",
)
"""What is asked if nothing is said."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SweepValues:
    """Quantities and outcomes of n scenes.

    Parameters
    ----------
    numbers : mapping of str to ndarray, shape (n,)
        By the names of quantities; NaN where a scene has none.
    outcomes : sequence of str
        How each scene ended.
    """

    numbers: Mapping[str, Floats]
    outcomes: Sequence[str]
