"""The registry of quantities: every number that tables, figures and verdicts take from a run.

Degrees, the finite part of a number and "None where there is none" are decided here, once. A study
picks quantities by key and adds what is its own: a tolerance, the ends of an axis.

Keys end with their unit. A turn is unresolved where the record is too coarse to tell how often psi
went round: `turn_deg`, `turn_error_deg` are then None, while `angle_of_turn_deg` and
`angle_of_turn_error_deg` give the turn as recorded, which is right up to whole turns.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Protocol

from harness.core.bounce import Bounce
from harness.core.report_model import Column
from harness.core.simulation import Simulation
from harness.metrics.contact import ContactQuality
from harness.metrics.error import Errors
from harness.metrics.motion import Motion

Number = float | None


class Measured(Protocol):
    """A simulation with what was measured of it: what a quantity is read from."""

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
    """Return a number, or None for what is none."""
    return value if value is not None and math.isfinite(value) else None


def turn_error(e: Measured, place: int = 0) -> Number:
    """Return the error of a resolved turn, deg; None if unresolved or not completed by both."""
    resolved = place < len(e.bounces) and e.bounces[place].resolved
    return recorded_turn_error(e, place) if resolved else None


def recorded_turn_error(e: Measured, place: int = 0) -> Number:
    """Return the error of a turn as recorded, deg, right up to whole turns if unresolved."""
    if e.errors is None or place >= len(e.errors.angle_of_turn):
        return None
    return math.degrees(e.errors.angle_of_turn[place])


def _period_error(e: Measured) -> Number:
    if not (e.bounces and e.true_bounces):
        return None
    run, true = e.bounces[0], e.true_bounces[0]
    return run.end - run.start - (true.end - true.start)


def _of_bounce(
    key: str, label: str, unit: str, meaning: str, read: Callable[[Bounce], Number]
) -> Quantity:
    """Return a quantity of bounces; that of a run is the one of its first bounce."""

    def number(bounce: Bounce) -> Number:
        return finite(read(bounce))

    return Quantity(
        key=key,
        label=label,
        unit=unit,
        meaning=meaning,
        of_run=lambda e: number(e.bounces[0]) if e.bounces else None,
        of_truth=lambda e: number(e.true_bounces[0]) if e.true_bounces else None,
        of_bounce=number,
    )


def _error(
    key: str,
    label: str,
    unit: str,
    meaning: str,
    read: Callable[[Errors], float | tuple[float, ...]],
) -> Quantity:
    """Return a quantity of the errors of a run: one number, or that of the first bounce."""

    def number(e: Measured) -> Number:
        found = () if e.errors is None else read(e.errors)
        if isinstance(found, tuple):
            return finite(found[0]) if found else None
        return finite(found)

    return Quantity(key=key, label=label, unit=unit, meaning=meaning, of_run=number)


def _of_contact(
    key: str, label: str, unit: str, meaning: str, read: Callable[[ContactQuality], float]
) -> Quantity:
    """Return a quantity of the contact, which is zero for a can that rolls."""
    return Quantity(
        key=key,
        label=label,
        unit=unit,
        meaning=meaning,
        of_run=lambda e: finite(read(e.contact)) if e.contact else None,
    )


def _at_end(name: str) -> Quantity:
    """Return an angle at the horizon, carried there from the last sample at its rate."""

    def read(e: Measured, motion: Motion | None) -> Number:
        end = e.simulation.case.scene.horizon.seconds
        if motion is None or end is None:
            return None
        late = end - motion.time[-1]
        if abs(late) > motion.time[-1] - motion.time[-2]:
            return None  # the run ended early
        angle, rate = getattr(motion.angles, name), getattr(motion.angles, f"{name}_dot")
        return finite(math.degrees(angle[-1] + rate[-1] * late))

    return Quantity(
        key=f"{name}_end_deg",
        label=f"{name} at the end",
        unit="degrees",
        meaning=f"Angle {name} at the horizon.",
        of_run=lambda e: read(e, e.motion),
        of_truth=lambda e: read(e, e.truth),
    )


def _last_phi(e: Measured) -> Number:
    """Return phi at the end, where the end is a time: where it is a maximum, time tells."""
    if e.motion is None or e.simulation.case.scene.horizon.seconds is None:
        return None
    return float(e.motion.angles.phi[-1])


def _last_place(axis: int) -> Callable[[Measured], Number]:
    def read(e: Measured) -> Number:
        return None if e.motion is None else finite(float(e.motion.trajectory.position[-1, axis]))

    return read


def _registry() -> Iterator[Quantity]:
    """Yield every quantity."""
    turn = "Change of psi between the maxima of phi around the first bounce"
    yield _of_bounce(
        "turn_deg",
        "angle of turn",
        "degrees",
        f"{turn}, if it can be counted.",
        lambda b: math.degrees(b.angle_of_turn) if b.resolved else None,
    )
    yield _of_bounce(
        "angle_of_turn_deg",
        "angle of turn",
        "degrees",
        f"{turn}.",
        lambda b: math.degrees(b.angle_of_turn),
    )
    yield _of_bounce(
        "rotation_turn_deg",
        "turn of theta",
        "degrees",
        "Signed change of theta between the maxima of phi around the bounce.",
        lambda b: math.degrees(b.rotation_turn),
    )
    yield _of_bounce(
        "period_s",
        "period",
        "s",
        "Time between the maxima of phi around the bounce.",
        lambda b: b.end - b.start,
    )
    yield _of_bounce(
        "bounce_time_s",
        "time of the bounce",
        "s",
        "Time of the first minimum of phi.",
        lambda b: b.time,
    )
    yield _of_bounce(
        "phi_min_rad",
        "smallest phi",
        "rad",
        "Smallest phi of the first bounce.",
        lambda b: b.phi_min,
    )
    yield _of_bounce(
        "peak_psi_dot_rad_s",
        "peak psi'",
        "rad/s",
        "Precession rate of largest magnitude in the bounce, with its sign.",
        lambda b: b.peak_psi_dot,
    )
    yield _of_bounce(
        "peak_friction_ratio",
        "peak friction ratio",
        "",
        "Largest |F|/N of the first bounce.",
        lambda b: b.peak_friction_ratio,
    )
    yield from map(_at_end, ("phi", "psi"))
    yield Quantity(
        key="phi_end_rad",
        label="nutation at the end",
        unit="rad",
        meaning="Nutation phi at the end of a run of given time.",
        of_run=_last_phi,
    )
    for axis, letter in enumerate("xy"):
        yield Quantity(
            key=f"{letter}_end_m",
            label=f"place at the end ({letter})",
            unit="m",
            meaning=f"Coordinate {letter} of the can's centre at the end.",
            of_run=_last_place(axis),
        )
    yield from _registry_of_errors()
    yield from _registry_of_contact()


def _registry_of_errors() -> Iterator[Quantity]:
    """Yield the quantities that are differences from the exact motion."""
    turn = "Angle of the first turn, engine minus truth"
    yield Quantity(
        key="turn_error_deg",
        label="angle of turn",
        unit="degrees",
        meaning=f"{turn}, where the record can count it.",
        of_run=turn_error,
    )
    yield Quantity(
        key="angle_of_turn_error_deg",
        label="angle of turn",
        unit="degrees",
        meaning=f"{turn}.",
        of_run=recorded_turn_error,
    )
    yield _error(
        "bounce_time_error_s",
        "time of the bounce",
        "s",
        "Time of the first minimum of phi, engine minus truth.",
        lambda errors: errors.time_of_bounce,
    )
    yield _error(
        "peak_friction_ratio_error",
        "peak friction ratio",
        "",
        "Largest |F|/N of the first bounce, engine minus truth.",
        lambda errors: errors.peak_friction_ratio,
    )
    yield _error(
        "phi_min_error_rad",
        "smallest phi",
        "rad",
        "Smallest phi of the first bounce, engine minus truth.",
        lambda errors: errors.phi_min,
    )
    yield Quantity(
        key="period_error_s",
        label="period",
        unit="s",
        meaning="Period of the first bounce, engine minus truth.",
        of_run=_period_error,
    )
    rms = "Root mean square error of phi over the run"
    yield _error("phi_rms_rad", "nutation phi (rms)", "rad", f"{rms}.", lambda e: e.phi_rms)
    yield _error(
        "phi_rms_before_rad",
        "nutation phi before the bounce (rms)",
        "rad",
        f"{rms}, up to the first bounce.",
        lambda e: e.phi_rms_before,
    )
    yield _error(
        "phi_rms_after_rad",
        "nutation phi after the bounce (rms)",
        "rad",
        f"{rms}, after the first bounce.",
        lambda e: e.phi_rms_after,
    )
    yield _error(
        "phi_max_rad",
        "nutation phi (largest)",
        "rad",
        "Largest error of phi over the run.",
        lambda e: e.phi_max,
    )
    between = "Angle between the true and the engine's orientation, root mean square."
    label = "orientation (rms)"
    yield _error("rotation_rms_rad", label, "rad", between, lambda e: e.rotation_rms)
    yield _error(
        "rotation_rms_deg", label, "degrees", between, lambda e: math.degrees(e.rotation_rms)
    )
    for name in ("psi", "theta"):
        yield _error(
            f"{name}_rms_rad",
            f"{name} (rms)",
            "rad",
            f"Root mean square error of {name}, without jumps.",
            lambda e, name=name: getattr(e, f"{name}_rms"),  # type: ignore[misc]
        )
    yield _error(
        "contact_locus_rms_m",
        "contact locus (rms)",
        "m",
        "Distance of the contact points at the same instant, root mean square.",
        lambda e: e.contact_locus_rms,
    )
    yield _error(
        "contact_locus_hausdorff_m",
        "contact locus (Hausdorff)",
        "m",
        "Largest distance between the two loci as curves.",
        lambda e: e.contact_locus_hausdorff,
    )


def _registry_of_contact() -> Iterator[Quantity]:
    """Yield what is zero for a can that rolls, and the work that a run took."""
    yield Quantity(
        key="energy_drift",
        label="energy drift",
        unit="m g R",
        meaning="Largest departure of the energy from its first value, over m g R.",
        of_run=lambda e: finite(e.energy_drift),
    )
    yield _of_contact(
        "max_penetration_m",
        "deepest penetration",
        "m",
        "Depth of the deepest contact.",
        lambda contact: contact.max_penetration,
    )
    yield _of_contact(
        "max_slip_m_s",
        "fastest slip",
        "m/s",
        "Largest horizontal speed of the can's material at the contact point.",
        lambda contact: contact.max_slip,
    )
    yield _of_contact(
        "lift_off_fraction",
        "time without contact",
        "of the time",
        "Share of the time without contact force.",
        lambda contact: contact.lift_off_fraction,
    )
    yield _of_contact(
        "multi_contact_fraction",
        "time with several contacts",
        "of the time",
        "Share of the time with several contact points that bear force.",
        lambda contact: contact.multi_contact_fraction,
    )
    for key, label, unit, meaning in (
        ("steps", "steps", "", "Timesteps taken."),
        (
            "constraint_rows",
            "constraint rows",
            "",
            "Rows that the solver worked on, summed over the steps.",
        ),
        ("setup_s", "time to set up", "s", "Compiling and probing, wall clock."),
        (
            "wall_s",
            "time by the clock",
            "s",
            "Stepping and reading, wall clock, while other cases may have run beside it.",
        ),
        ("cpu_s", "time of the processor", "s", "Stepping and reading, processor time."),
    ):
        yield Quantity(
            key=key,
            label=label,
            unit=unit,
            meaning=meaning,
            of_run=lambda e, key=key: getattr(e.simulation, key),  # type: ignore[misc]
        )


QUANTITIES: Mapping[str, Quantity] = MappingProxyType({q.key: q for q in _registry()})
"""Every quantity by its key."""


def column(key: str, *, shown: bool = False) -> Column:
    """Return the column of a quantity in a table whose records are runs."""
    chosen = QUANTITIES[key]
    return Column(key, chosen.meaning, chosen.of_run, shown)
