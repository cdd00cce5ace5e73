"""What a sweep may ask of each scene: a column each, all of the first bounce.

What was found of consecutive scenes of a sweep.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from harness.metrics.quantities import QUANTITIES as REGISTRY
from harness.metrics.quantities import Quantity
from harness.sweep.parameters import Floats

EPSILON = Quantity(
    key="epsilon",
    label="epsilon",
    unit="",
    meaning="The paper's small parameter, B_-2 squared with rates in sqrt(g/R), of the "
    "release: its square root measures how far the can is from falling flat.",
    of_run=lambda _: None,  # of a release, not of a run
)

SOURCES: Mapping[str, Literal["exact", "run", "error"]] = {
    "angle_of_turn_deg": "exact",
    "rotation_turn_deg": "exact",
    "period_s": "exact",
    "phi_min_rad": "exact",
    "peak_psi_dot_rad_s": "exact",
    "epsilon": "exact",
    "peak_friction_ratio": "run",
    "energy_drift": "run",
    "steps": "run",
    "angle_of_turn_error_deg": "error",
    "period_error_s": "error",
    "phi_min_error_rad": "error",
}
"""Where each quantity comes from.

"exact": the exact bounce has it, as a formula for many releases at once; "run": only a whole motion
has it; "error": an engine's value minus the exact one.
"""

QUANTITIES: Mapping[str, Quantity] = {
    name: EPSILON if name == "epsilon" else REGISTRY[name] for name in SOURCES
}
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
