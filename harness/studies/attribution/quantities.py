"""The discrepancies that are attributed, each read from an evaluation, or None where unknown."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from harness.evaluation.evaluation import Evaluation


@dataclass(frozen=True, slots=True, kw_only=True)
class AttributedQuantity:
    """One discrepancy.

    Parameters
    ----------
    key : str
        Column name, with the unit as the suffix.
    words : str
        As a sentence says it.
    unit : str
        As a sentence and an axis say it; empty for a ratio.
    scale : float
        From the unit of the column to the unit in words.
    meaning : str
    read : callable
        None where the evaluation does not know it.
    """

    key: str
    words: str
    unit: str
    scale: float = 1.0
    meaning: str
    read: Callable[[Evaluation], float | None]


def turn(e: Evaluation) -> float | None:
    """Return the error of the first angle of turn, deg; None where psi cannot be counted."""
    return turn_seen(e) if e.bounces and e.bounces[0].resolved else None


def uncounted(evaluations: Iterable[Evaluation]) -> int:
    """Return in how many runs of a scene that ends with a bounce the turn is not known."""
    return sum(
        turn(e) is None for e in evaluations if e.simulation.case.scene.horizon.seconds is None
    )


def turn_seen(e: Evaluation) -> float | None:
    """Return the same as the record has it, whether or not it is dense enough to count turns."""
    if e.errors is None or not e.errors.angle_of_turn:
        return None
    return math.degrees(e.errors.angle_of_turn[0])


def _friction(e: Evaluation) -> float | None:
    if e.errors is None or not e.errors.peak_friction_ratio:
        return None
    return _known(e.errors.peak_friction_ratio[0])


def _known(value: float) -> float | None:
    """Return a number, or None for what is none."""
    return value if math.isfinite(value) else None


QUANTITIES = (
    AttributedQuantity(
        key="turn_error_deg",
        words="angle of turn",
        unit="degrees",
        meaning="Angle of the first turn, engine minus truth, where the record can count it.",
        read=turn,
    ),
    AttributedQuantity(
        key="contact_locus_rms_m",
        words="contact locus (rms)",
        unit="mm",
        scale=1e3,
        meaning="Distance of the contact points at the same instant, root mean square.",
        read=lambda e: _known(e.errors.contact_locus_rms) if e.errors else None,
    ),
    AttributedQuantity(
        key="phi_rms_rad",
        words="nutation phi (rms)",
        unit="mrad",
        scale=1e3,
        meaning="Error of phi over the run, root mean square.",
        read=lambda e: _known(e.errors.phi_rms) if e.errors else None,
    ),
    AttributedQuantity(
        key="peak_friction_ratio_error",
        words="peak friction ratio",
        unit="",
        meaning="Largest |F|/N of the first bounce, engine minus truth.",
        read=_friction,
    ),
    AttributedQuantity(
        key="contact_locus_hausdorff_m",
        words="contact locus (Hausdorff)",
        unit="mm",
        scale=1e3,
        meaning="Largest distance between the two loci as curves.",
        read=lambda e: _known(e.errors.contact_locus_hausdorff) if e.errors else None,
    ),
)
"""In the order in which words and figures take them."""
