"""What a record alone tells of the can and of gravity, beside what the scene declares.

While the rim touches, the height of the centre is z = R sin phi + H cos phi, less the depth: a fit
tells R and H. In free flight z is a parabola, and tells g. Rolling conserves the energy, so that

    v^2/2 + (A/m) w_t^2/2 + (C/m) w_a^2/2 + g z = constant

with the parts of the angular velocity across and along the can: a fit tells A/m, C/m and g.

What a fit leaves is no noise: contacts are soft and solvers lose energy. So the remainder counts as
if it all pushed one way, the two halves of the motion are fitted by themselves too, and a value is
told only where all agree. What is not told is declared, and not checked.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from harness.core.simulation import ParityRow
from harness.core.trajectory import Floats, Trajectory
from harness.metrics.energy import conserves_energy
from models.kinematics import angles, to_body
from models.scene import Scene

NOT_CHECKED = "not checked"
"""Verdict on what a record does not tell."""

_KNOWN = 0.02
"""Relative uncertainty up to which a value is told."""

_EQUAL = 0.01
"""Relative difference up to which a value is the declared one, beside its uncertainty."""

_SIGMAS = 4.0

_FLIGHT = 12
"""Samples in the air that make a parabola."""


@dataclass(frozen=True, slots=True)
class _Fitted:
    """A value, its uncertainty, how it was found, and whether the other unknowns are known too.

    Where they are not, a value may have taken up what is theirs: it confirms, and refutes nothing.
    """

    value: float
    uncertainty: float
    how: str
    alone: bool


def evidence(trajectory: Trajectory, scene: Scene) -> tuple[ParityRow, ...]:
    """Return what a record tells of a scene's can and gravity, row by row."""
    can = scene.can
    found = dict(_found(trajectory, scene))
    declared = (
        ("mass m", "kg", can.mass),
        ("radius R", "m", can.radius),
        ("half height H", "m", can.half_height),
        ("transverse inertia A/m", "m^2", can.transverse_inertia / can.mass),
        ("axial inertia C/m", "m^2", can.axial_inertia / can.mass),
        ("gravity g", "m/s^2", scene.gravity),
    )
    return tuple(
        _row(quantity, unit, value, found.get(quantity)) for quantity, unit, value in declared
    )


def _row(quantity: str, unit: str, declared: float, found: _Fitted | None) -> ParityRow:
    """Return a row: equal, a mismatch, or not checked."""
    if found is None or not found.uncertainty <= _KNOWN * abs(declared):
        how = "declared; the record does not tell" if found is None else f"{found.how}: too vague"
        return ParityRow(quantity, unit, declared, declared, how, NOT_CHECKED)
    allowed = max(_EQUAL * abs(declared), _SIGMAS * found.uncertainty)
    equal = abs(found.value - declared) <= allowed
    if not equal and not found.alone:
        how = f"{found.how}, which does not tell the unknowns apart"
        return ParityRow(quantity, unit, declared, declared, how, NOT_CHECKED)
    how = f"{found.how}, +- {found.uncertainty:.1g}"
    return ParityRow(quantity, unit, declared, found.value, how, "equal" if equal else "mismatch")


def _found(trajectory: Trajectory, scene: Scene) -> Iterator[tuple[str, _Fitted]]:
    """Yield what can be fitted."""
    phi, _, _ = angles(trajectory.quaternion)
    z = trajectory.position[:, 2]
    touching = trajectory.contact_count > 0
    if touching.sum() > _FLIGHT and scene.effects.rim is None:
        depth = np.nan_to_num(trajectory.penetration[touching])
        sides = np.column_stack((np.sin(phi[touching]), np.cos(phi[touching])))
        how = "fit of the height of the centre over the tilt"
        fitted = _fit(sides, z[touching] + depth, how, 2)
        yield from zip(("radius R", "half height H"), fitted, strict=True)
    of_symmetric_can = scene.effects.tilt is None and scene.effects.point_mass is None
    if of_symmetric_can and conserves_energy(scene) and touching.all():
        spin = to_body(trajectory.quaternion, trajectory.angular_velocity)
        across = 0.5 * np.sum(spin[:, :2] ** 2, axis=1)
        along = 0.5 * spin[:, 2] ** 2
        kinetic = 0.5 * np.sum(trajectory.velocity**2, axis=1)
        sides = np.column_stack((across, along, z, -np.ones_like(z)))
        how = "fit of the energy, which rolling conserves"
        names = ("transverse inertia A/m", "axial inertia C/m", "gravity g")
        yield from zip(names, _fit(sides, -kinetic, how, 3), strict=True)
    flight = _longest(~touching)
    if flight.stop - flight.start >= _FLIGHT:
        t = trajectory.time[flight] - trajectory.time[flight].mean()
        sides = np.column_stack((-0.5 * t**2, t, np.ones_like(t)))
        (fall,) = _fit(sides, z[flight], "fit of a parabola in free flight", 1)
        yield "gravity g", fall


def _fit(sides: Floats, values: Floats, how: str, count: int) -> list[_Fitted]:
    """Return the first unknowns of linear equations by least squares, with their uncertainties."""
    found, spread = _least_squares(sides, values)
    half = len(values) // 2
    for part in (slice(half), slice(half, None)):
        own, wide = _least_squares(sides[part], values[part])
        spread = np.maximum(spread, np.where(np.isfinite(wide), np.abs(own - found), np.inf))
    spread = np.where(found > 0.0, spread, np.inf)  # masses, moments and lengths are positive
    found, spread = found[:count], spread[:count]
    alone = bool((spread <= _KNOWN * np.abs(found)).all())
    return [
        _Fitted(value, sigma, how, alone)
        for value, sigma in zip(found.tolist(), spread.tolist(), strict=True)
    ]


def _least_squares(sides: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Return the unknowns of linear equations, and what the remainder may do to each."""
    scale = np.linalg.norm(sides, axis=0)
    scale[scale == 0.0] = 1.0
    unknowns, _, _, singular = np.linalg.lstsq(sides / scale, values, rcond=None)
    rest = values - sides @ (unknowns / scale)
    with np.errstate(divide="ignore", invalid="ignore"):
        _, _, turned = np.linalg.svd(sides / scale, full_matrices=False)
        reach = np.sqrt(np.sum((turned / singular[:, None]) ** 2, axis=0)) / scale
    # a direction that the record does not move in tells nothing, however small the rest
    told = np.abs(turned[singular <= 1e-9 * singular[0]]).max(axis=0, initial=0.0) < 1e-6  # noqa: PLR2004
    return unknowns / scale, np.where(told, float(np.linalg.norm(rest)) * reach, np.inf)


def _longest(flags: np.ndarray) -> slice:
    """Return the longest range of true flags."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(np.int8), [0]))))
    starts, ends = edges[::2], edges[1::2]
    if not len(starts):
        return slice(0, 0)
    longest = int(np.argmax(ends - starts))
    return slice(int(starts[longest]), int(ends[longest]))
