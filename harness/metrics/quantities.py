"""The registry of quantities: every number that tables, figures and verdicts take from a run.

Degrees, the finite part of a number and "None where there is none" are decided here, once. A study
picks quantities by key and adds what is its own: a tolerance, the ends of an axis.

Keys end with their unit. A turn is unresolved where the record is too coarse to tell how often psi
went round: `turn_deg`, `turn_error_deg` are then None, while `angle_of_turn_deg` and
`angle_of_turn_error_deg` give the turn as recorded, which is right up to whole turns.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from operator import attrgetter
from types import MappingProxyType
from typing import Protocol

from harness.core.bounce import Bounce
from harness.core.case import RECORDED
from harness.core.simulation import Simulation
from harness.metrics.error import Errors
from harness.metrics.motion import ContactQuality, Motion

Number = float | None


class Measured(Protocol):
    """A simulation and its measurements, from which quantities are read."""

    @property
    def simulation(self) -> Simulation: ...  # noqa: D102 - as in `harness.evaluation.Evaluation`
    @property
    def motion(self) -> Motion | None: ...  # noqa: D102
    @property
    def bounces(self) -> tuple[Bounce, ...]: ...  # noqa: D102
    @property
    def energy_drift(self) -> float | None: ...  # noqa: D102
    @property
    def contact(self) -> ContactQuality | None: ...  # noqa: D102
    @property
    def truth(self) -> Motion | None: ...  # noqa: D102
    @property
    def true_bounces(self) -> tuple[Bounce, ...]: ...  # noqa: D102
    @property
    def errors(self) -> Errors | None: ...  # noqa: D102


def _none(_: object) -> Number:
    return None


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """A number of a run; None where the run has none.

    Parameters
    ----------
    key : str
        Name of its column, with the unit as the suffix.
    label : str
        As a sentence says it, and an axis; of an error, what is in error.
    unit : str
        As a sentence says it; empty for a ratio or a count.
    meaning : str
        One sentence.
    of_run, of_truth : callable
        The number of a run, and the same number of the exact motion. An error has no such number.
    of_bounce : callable
        The number of one bounce; None if the quantity is none of a bounce.
    """

    key: str
    label: str
    unit: str
    meaning: str
    of_run: Callable[[Measured], Number]
    of_truth: Callable[[Measured], Number] = _none
    of_bounce: Callable[[Bounce], Number] = _none

    @property
    def axis(self) -> str:
        """Return the label of an axis, with the unit in brackets."""
        unit = "deg" if self.unit == "degrees" else self.unit
        return f"{self.label} [{unit}]" if unit else self.label


def finite(value: Number) -> Number:
    """Return a finite number as it is, and None for NaN, infinity and None."""
    return value if value is not None and math.isfinite(value) else None


def less(first: Number, second: Number) -> Number:
    """Return the first less the second; None if one of the two is not known."""
    return None if first is None or second is None else first - second


def turn_error(e: Measured, place: int = 0) -> Number:
    """Return the error of a resolved turn, deg; None if unresolved or not completed by both."""
    resolved = place < len(e.bounces) and e.bounces[place].resolved
    return recorded_turn_error(e, place) if resolved else None


def recorded_turn_error(e: Measured, place: int = 0) -> Number:
    """Return the error of a turn as recorded, deg, right up to whole turns if unresolved."""
    if e.errors is None or place >= len(e.errors.angle_of_turn):
        return None
    return math.degrees(e.errors.angle_of_turn[place])


_UNITS = {
    "rad_s": "rad/s",
    "m_s": "m/s",
    "deg": "degrees",
    "rad": "rad",
    "m": "m",
    "s": "s",
    "fraction": "of the time",
}
"""Unit in words by the suffix of a key; longer suffixes first."""


def _unit(key: str) -> tuple[str, str]:
    """Return a key without its suffix, and the unit in words."""
    for suffix, unit in _UNITS.items():
        if key.endswith(f"_{suffix}"):
            return (key if suffix == "fraction" else key.removesuffix(f"_{suffix}")), unit
    return key, ""


def _number(key: str, value: float) -> Number:
    """Return a value of the library, which has radians, in the unit of a key."""
    return finite(math.degrees(value) if key.endswith("_deg") else value)


def _of_bounce(
    key: str, label: str, meaning: str, read: Callable[[Bounce], float] | None = None
) -> Quantity:
    """Return a quantity of bounces; that of a run is the one of its first bounce."""
    name, unit = _unit(key)
    value = read or attrgetter(name)

    def of_bounce(bounce: Bounce) -> Number:
        return _number(key, value(bounce))

    return Quantity(
        key=key,
        label=label,
        unit=unit,
        meaning=meaning,
        of_run=lambda e: of_bounce(e.bounces[0]) if e.bounces else None,
        of_truth=lambda e: of_bounce(e.true_bounces[0]) if e.true_bounces else None,
        of_bounce=of_bounce,
    )


def _of_part(part: str, key: str, label: str, meaning: str, name: str = "") -> Quantity:
    """Return a quantity of a part of a run: its errors, its contact, or its simulation.

    Where the part has a number for each bounce, the quantity is that of the first.
    """
    of_key, unit = _unit(key)

    def of_run(e: Measured) -> Number:
        untold = part == "simulation" or key == "multi_contact_fraction"
        if untold and e.simulation.case.profile == RECORDED:
            return None  # a record has no steps, times or counts
        value = getattr(getattr(e, part), name or of_key, None)
        if isinstance(value, tuple):
            value = value[0] if value else None
        return None if value is None else _number(key, value)

    return Quantity(key=key, label=label, unit=unit, meaning=meaning, of_run=of_run)


def _of_motion(
    key: str, label: str, meaning: str, read: Callable[[Measured, Motion], Number]
) -> Quantity:
    """Return a quantity of a whole motion."""
    return Quantity(
        key=key,
        label=label,
        unit=_unit(key)[1],
        meaning=meaning,
        of_run=lambda e: None if e.motion is None else read(e, e.motion),
        of_truth=lambda e: None if e.truth is None else read(e, e.truth),
    )


def _at_end(name: str) -> Quantity:
    """Return an angle at the horizon, carried there from the last sample at its rate."""

    def read(e: Measured, motion: Motion) -> Number:
        end = e.simulation.case.scene.horizon.seconds
        late = math.inf if end is None else end - motion.time[-1]
        if abs(late) > motion.time[-1] - motion.time[-2]:
            return None  # no such horizon, or the run ended early
        angle, rate = getattr(motion.angles, name), getattr(motion.angles, f"{name}_dot")
        return finite(math.degrees(angle[-1] + rate[-1] * late))

    return _of_motion(
        f"{name}_end_deg", f"{name} at the end", f"Angle {name} at the horizon.", read
    )


def _last_phi(e: Measured, motion: Motion) -> Number:
    """Return phi at the end, where the end is a time: where it is a maximum, time tells."""
    timed = e.simulation.case.scene.horizon.seconds is not None
    return float(motion.angles.phi[-1]) if timed else None


def _last_place(axis: int) -> Callable[[Measured, Motion], Number]:
    return lambda _, motion: finite(float(motion.trajectory.position[-1, axis]))


def _period_error(e: Measured) -> Number:
    return less(QUANTITIES["period_s"].of_run(e), QUANTITIES["period_s"].of_truth(e))


_TURN = "Change of psi between the maxima of phi around the first bounce"
_TURN_ERROR = "Angle of the first turn, engine minus truth"
_PHI_RMS = "Root mean square error of phi over the run"
_BETWEEN = "Angle between the true and the engine's orientation, root mean square."

_ALL = (
    _of_bounce(
        "turn_deg",
        "angle of turn",
        f"{_TURN}, if it can be counted.",
        lambda bounce: bounce.angle_of_turn if bounce.resolved else math.nan,
    ),
    _of_bounce("angle_of_turn_deg", "angle of turn", f"{_TURN}."),
    _of_bounce(
        "rotation_turn_deg",
        "turn of theta",
        "Signed change of theta between the maxima of phi around the bounce.",
    ),
    _of_bounce(
        "period_s",
        "period",
        "Time between the maxima of phi around the bounce.",
        lambda bounce: bounce.end - bounce.start,
    ),
    _of_bounce(
        "bounce_time_s",
        "time of the bounce",
        "Time of the first minimum of phi.",
        lambda bounce: bounce.time,
    ),
    _of_bounce("phi_min_rad", "smallest phi", "Smallest phi of the first bounce."),
    _of_bounce(
        "peak_psi_dot_rad_s",
        "peak psi'",
        "Precession rate of largest magnitude in the bounce, with its sign.",
    ),
    _of_bounce("peak_friction_ratio", "peak friction ratio", "Largest |F|/N of the first bounce."),
    _at_end("phi"),
    _at_end("psi"),
    _of_motion(
        "phi_end_rad",
        "nutation at the end",
        "Nutation phi at the end of a run of given time.",
        _last_phi,
    ),
    *(
        _of_motion(
            f"{letter}_end_m",
            f"place at the end ({letter})",
            f"Coordinate {letter} of the can's centre at the end.",
            _last_place(axis),
        )
        for axis, letter in enumerate("xy")
    ),
    Quantity(
        key="turn_error_deg",
        label="angle of turn",
        unit="degrees",
        meaning=f"{_TURN_ERROR}, where the record can count it.",
        of_run=turn_error,
    ),
    Quantity(
        key="angle_of_turn_error_deg",
        label="angle of turn",
        unit="degrees",
        meaning=f"{_TURN_ERROR}.",
        of_run=recorded_turn_error,
    ),
    Quantity(
        key="period_error_s",
        label="period",
        unit="s",
        meaning="Period of the first bounce, engine minus truth.",
        of_run=_period_error,
    ),
    *(
        _of_part("errors", *words)
        for words in (
            (
                "bounce_time_error_s",
                "time of the bounce",
                "Time of the first minimum of phi, engine minus truth.",
                "time_of_bounce",
            ),
            (
                "peak_friction_ratio_error",
                "peak friction ratio",
                "Largest |F|/N of the first bounce, engine minus truth.",
                "peak_friction_ratio",
            ),
            (
                "phi_min_error_rad",
                "smallest phi",
                "Smallest phi of the first bounce, engine minus truth.",
                "phi_min",
            ),
            ("phi_rms_rad", "nutation phi (rms)", f"{_PHI_RMS}."),
            (
                "phi_rms_before_rad",
                "nutation phi before the bounce (rms)",
                f"{_PHI_RMS}, up to the first bounce.",
            ),
            (
                "phi_rms_after_rad",
                "nutation phi after the bounce (rms)",
                f"{_PHI_RMS}, after the first bounce.",
            ),
            ("phi_max_rad", "nutation phi (largest)", "Largest error of phi over the run."),
            ("rotation_rms_rad", "orientation (rms)", _BETWEEN),
            ("rotation_rms_deg", "orientation (rms)", _BETWEEN),
            ("psi_rms_rad", "psi (rms)", "Root mean square error of psi, without jumps."),
            ("theta_rms_rad", "theta (rms)", "Root mean square error of theta, without jumps."),
            (
                "contact_locus_rms_m",
                "contact locus (rms)",
                "Distance of the contact points at the same instant, root mean square.",
            ),
            (
                "contact_locus_hausdorff_m",
                "contact locus (Hausdorff)",
                "Largest distance between the two loci as curves.",
            ),
        )
    ),
    Quantity(
        key="energy_drift",
        label="energy drift",
        unit="m g R",
        meaning="Largest departure of the energy from its first value, over m g R.",
        of_run=lambda e: finite(e.energy_drift),
    ),
    *(
        _of_part("contact", *words)
        for words in (
            ("max_penetration_m", "deepest penetration", "Depth of the deepest contact."),
            (
                "max_slip_m_s",
                "fastest slip",
                "Largest horizontal speed of the can's material at the contact point.",
            ),
            (
                "lift_off_fraction",
                "time without contact",
                "Share of the time without contact force.",
            ),
            (
                "multi_contact_fraction",
                "time with several contacts",
                "Share of the time with several contact points that bear force.",
            ),
        )
    ),
    *(
        _of_part("simulation", *words)
        for words in (
            ("steps", "steps", "Timesteps taken."),
            (
                "constraint_rows",
                "constraint rows",
                "Rows that the solver worked on, summed over the steps.",
            ),
            ("compile_s", "time to compile", "Compiling the engine, on first use.", "compile_s"),
            ("setup_s", "time to set up", "Compiling the model and probing it.", "setup_s"),
            (
                "wall_s",
                "time by the clock",
                "Stepping and reading, wall clock, while other cases may have run beside it.",
                "wall_s",
            ),
            (
                "cpu_s",
                "time of the processor",
                "Stepping and reading, processor time.",
                "cpu_s",
            ),
        )
    ),
)

QUANTITIES: Mapping[str, Quantity] = MappingProxyType({q.key: q for q in _ALL})
"""Every quantity by its key."""
