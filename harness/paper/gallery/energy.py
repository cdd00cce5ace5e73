"""The Hamiltonian of the reduced equation: as a surface and by its contours."""

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from harness.core.report_model import Figure, Panel, Series
from harness.core.trajectory import Floats  # noqa: TC001 - as the other figures import it
from harness.paper.gallery.release import FOURTH_CURVE, OURS, SECOND_CURVE, line, problem
from reference.asymptotic.small_nutation import Reduced, reduced_of

LEVELS = (7.5e-4, 1e-3, 2e-3, 3e-3, 4e-3, 5e-3)
SLICES, SAMPLES = 42, 1201
TOP = 1e-2
"""Where the surface is cut: the wall at phi = 0 has no top."""
SHIFT, LIFT = 0.6, 1.1
"""By how much the back of the surface is moved to the right and up."""


def surface() -> Figure:
    """Slices of the surface at constant phi, those behind hidden (fig01:hamiltonian_3D)."""
    reduced = reduced_of(problem(bounces=1))
    widest = 0.1
    speed = np.linspace(-widest, widest, SAMPLES)
    across = np.linspace(-1.0, 1.0 + SHIFT, SAMPLES)
    series = []
    hidden_below = np.full(SAMPLES, -np.inf)
    floor: list[tuple[float, float]] = []
    nearest, farthest = 5e-3, 8e-5
    for depth in np.linspace(0, 1, SLICES):
        phi = nearest * (farthest / nearest) ** depth
        height = reduced.hamiltonian(speed, np.asarray(phi)) / TOP
        height[height > 1] = np.nan
        # oblique view: slices further back stand higher and further to the right
        place = speed / widest + SHIFT * depth
        lifted = np.interp(across, place, height + LIFT * depth, left=np.nan, right=np.nan)
        free = lifted > hidden_below
        middle = np.abs(across - SHIFT * depth).argmin()
        floor.append((across[middle], lifted[middle] if free[middle] else np.nan))
        drawn = np.where(free, lifted, np.nan)
        if np.isfinite(drawn).any():
            series.append(line("slices at constant phi", across, drawn, SECOND_CURVE))
        hidden_below = np.fmax(hidden_below, lifted)
    seen = np.array(floor)
    series.append(line("phi' = 0", seen[:, 0], seen[:, 1], FOURTH_CURVE, dashed=True))
    lowest = _bottom(reduced)
    return Figure(
        name="fig01-hamiltonian_3D",
        title="The Hamiltonian surface",
        seen=(
            f"A valley falls with phi to H = {lowest[1]:.2e} at phi = {lowest[0]:.2e}. "
            "Behind it stands the wall that the repulsion raises at phi = 0, cut off here at "
            f"{TOP:g}."
        ),
        panels=(
            Panel(
                title=f"phi from {nearest:g} in front to {farthest:g} behind, by its logarithm",
                x_label=f"phi'/{widest:g}, and phi into the page",
                y_label=f"H/{TOP:g}, and phi into the page",
                series=tuple(series),
            ),
        ),
        columns=1,
    )


def contours() -> Figure:
    """Draw the contours that the paper names (fig01:hamiltonian_contours)."""
    reduced = reduced_of(problem(bounces=1))
    low, value = _bottom(reduced)
    made = [_contour(reduced, level, low) for level in LEVELS if level > value]
    centre = Series(
        label="steady motion",
        kind=SECOND_CURVE,
        x=np.array([low]),
        y=np.array([0.0]),
        mark="points",
    )
    return Figure(
        name="fig01-hamiltonian_contours",
        title="Contours of the Hamiltonian",
        seen=(
            f"Closed orbits about the steady motion at phi = {low:.2e}, H = {value:.2e}, run "
            f"through clockwise; {len(made)} of the paper's {len(LEVELS)} levels lie above it. "
            "With the eps that the paper prints, four times too large, the lowest would not exist."
        ),
        panels=(
            Panel(
                title="H = 7.5e-4, 1e-3, 2e-3, 3e-3, 4e-3, 5e-3",
                x_label="phi [rad]",
                y_label="phi' [sqrt(g/((a_p + 1) R))]",
                series=(*made, centre),
            ),
        ),
        columns=1,
    )


def _bottom(reduced: Reduced) -> tuple[float, float]:
    """Return the nutation of the steady motion and the Hamiltonian there."""
    found = minimize_scalar(
        lambda x: float(reduced.potential(np.asarray(np.exp(x)))),
        bounds=(np.log(1e-5), np.log(1e-2)),
        method="bounded",
        options={"xatol": 1e-10},
    )
    return float(np.exp(found.x)), float(found.fun)


def _contour(reduced: Reduced, level: float, low: float) -> Series:
    def above(x: float) -> float:
        return float(reduced.potential(np.asarray(x))) - level

    ends = brentq(above, 1e-6, low, xtol=1e-14), brentq(above, low, 2 * level + 1e-2, xtol=1e-14)
    # even in the angle about the centre, so that both turning points are dense
    turn = np.linspace(0, np.pi, 400)
    phi: Floats = ends[0] * (ends[1] / ends[0]) ** ((1 - np.cos(turn)) / 2)
    square = 2 * (level - reduced.potential(phi))
    speed = np.sqrt(np.maximum(square, 0))
    return line(
        "orbits",
        np.concatenate([phi, phi[::-1]]),
        np.concatenate([speed, -speed[::-1]]),
        OURS,
    )
