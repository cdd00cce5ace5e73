"""The Hamiltonian of the reduced equation; effective potential, steady motions and their folds."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

from harness.core.report_model import Figure, Heatmap, Panel, Series
from harness.core.trajectory import Floats  # noqa: TC001 - as the other figures import it
from harness.paper.gallery.curves import figure, line, panel, points, where
from harness.paper.release import problem
from reference import Parameters, Problem
from reference.asymptotic.small_nutation import Reduced, reduced_of
from reference.equations.bifurcation import (
    SteadyMotions,
    branches,
    effective_potential,
    folds,
    folds_at,
    force_form,
    states_at,
    steady_motions,
)

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
            series.append(line("slices at constant phi", across, drawn, 2))
        hidden_below = np.fmax(hidden_below, lifted)
    seen = np.array(floor)
    series.append(line("phi' = 0", seen[:, 0], seen[:, 1], 4, dashed=True))
    lowest = _bottom(reduced)
    return figure(
        "fig01-hamiltonian_3D",
        "The Hamiltonian surface",
        (
            f"A valley falls with phi to H = {lowest[1]:.2e} at phi = {lowest[0]:.2e}. "
            "Behind it stands the wall that the repulsion raises at phi = 0, cut off here at "
            f"{TOP:g}."
        ),
        panel(
            f"phi from {nearest:g} in front to {farthest:g} behind, by its logarithm",
            f"phi'/{widest:g}, and phi into the page",
            f"H/{TOP:g}, and phi into the page",
            *series,
        ),
    )


def contours() -> Figure:
    """Draw the contours that the paper names (fig01:hamiltonian_contours)."""
    reduced = reduced_of(problem(bounces=1))
    low, value = _bottom(reduced)
    orbits = [_contour(reduced, level, low) for level in LEVELS if level > value]
    centre = points("steady motion", np.array([low]), np.array([0.0]), 2)
    return figure(
        "fig01-hamiltonian_contours",
        "Contours of the Hamiltonian",
        (
            f"Closed orbits about the steady motion at phi = {low:.2e}, H = {value:.2e}, run "
            f"through clockwise; {len(orbits)} of the paper's {len(LEVELS)} levels lie above it. "
            "With the eps that the paper prints, four times too large, the lowest would not exist."
        ),
        panel(
            "H = 7.5e-4, 1e-3, 2e-3, 3e-3, 4e-3, 5e-3",
            "phi [rad]",
            "phi' [sqrt(g/((a_p + 1) R))]",
            *orbits,
            centre,
        ),
    )


def _bottom(reduced: Reduced) -> tuple[float, float]:
    """Return the nutation of the steady motion and the Hamiltonian there."""
    lowest = minimize_scalar(
        lambda x: float(reduced.potential(np.asarray(np.exp(x)))),
        bounds=(np.log(1e-5), np.log(1e-2)),
        method="bounded",
        options={"xatol": 1e-10},
    )
    return float(np.exp(lowest.x)), float(lowest.fun)


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
        "orbits", np.concatenate([phi, phi[::-1]]), np.concatenate([speed, -speed[::-1]]), 1
    )


STABLE, UNSTABLE = "stable steady motion", "unstable steady motion"
NUTATION_SAMPLES = 4000
FLAT, UPRIGHT = 1e-2, np.pi / 2
ROOM = 0.35
"""Below and above what is marked in a potential, as a share of the height between."""
CELLS, NUTATIONS = 80, 300
"""Levels along each first integral whose wells are counted, and where each is looked at."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Release:
    """A can at rest in phi, and what is drawn of it.

    Parameters
    ----------
    name : str
    posed : Problem
    whole, well : tuple of 2 floats
        Nutations between which the potential is drawn, and the well of the release by itself.
    B : tuple of 2 floats
        Between which the steady motions are drawn.
    plane : tuple of 4 floats
        Least and largest B_-2, and K, of the first integrals whose wells are counted.
    """

    name: str
    posed: Problem
    whole: tuple[float, float]
    well: tuple[float, float]
    B: tuple[float, float]
    plane: tuple[float, float, float, float]

    @property
    def own(self) -> SteadyMotions:
        """The first integrals and the energy of the release, shapes (1,)."""
        p = self.posed
        return states_at(p.parameters, *(np.array([x]) for x in (p.phi, p.psi_dot, p.theta_dot)))

    @property
    def level(self) -> tuple[float, float]:
        """The first integrals K and B_-2."""
        return float(self.own.K[0]), float(self.own.B[0])

    @property
    def steady(self) -> SteadyMotions:
        """The steady motions with the first integrals of the release."""
        return steady_motions(self.posed.parameters, *self.level)


RELEASES = (
    Release(
        name="two wells",
        posed=Problem(
            parameters=Parameters(a=0.2919, c=0.3791, h=0.5575),
            phi=1.5026354274572624,
            psi_dot=-0.39236159644870505,
            theta_dot=-1.0199477967008015,
            bounces=1,
        ),
        whole=(0.5, UPRIGHT),
        well=(1.40, 1.54),
        B=(0.45, 0.5),
        plane=(0.3, 0.65, -0.3, 0.2),
    ),
    Release(
        name="paper",
        posed=problem(bounces=1),
        whole=(1e-3, 1.0),
        well=(3e-5, 5e-2),
        B=(-0.1, 0.1),
        plane=(-0.85, 0.85, -1.6, 1.6),
    ),
)


def wells() -> Figure:
    """Two cans, one with a second well: potential, its well, steady motions, folds."""
    rows = (
        [_potential(release, release.whole, "effective potential") for release in RELEASES],
        [_potential(release, release.well, "the well of the release") for release in RELEASES],
        map(_branches, RELEASES),
        map(_plane, RELEASES),
    )
    upper, paper = RELEASES
    known, can = upper.steady, upper.posed.parameters
    barrier = float(known.energy[1] - upper.own.energy[0])
    return figure(
        "wells",
        "Effective potential, steady motions and their folds",
        (
            f"Left, a can with a = {can.a}, c = {can.c} and h = {can.h} has {known.phi.size} "
            "steady motions on the level of its release, centres at phi = "
            f"{known.phi[0]:.3f} and {known.phi[2]:.3f} with a saddle at {known.phi[1]:.3f} "
            f"between them, and released at {upper.posed.phi:.3f} it stays in the upper well, "
            f"under a barrier {barrier:.1e} m g R above its energy. Right, the paper's can and "
            f"release have one well, whose centre lies at phi = {paper.steady.phi[0]:.2e}; a well "
            "begins or ends at a fold, or where its steady motion passes phi = pi/2."
        ),
        *(each for row in rows for each in row),
    )


def _potential(release: Release, ends: tuple[float, float], what: str) -> Panel:
    """Draw the potential between two nutations, what is steady there, and the release's energy."""
    own, steady = release.own, release.steady
    wide = ends == release.well and ends[1] > 1e2 * ends[0]
    space = np.geomspace if wide else np.linspace
    phi = space(*ends, NUTATION_SAMPLES)
    V = effective_potential(release.posed.parameters, phi, *release.level)
    inside = (steady.phi > ends[0]) & (steady.phi < ends[1])
    reached = np.where(own.energy[0] >= V, own.energy[0], np.nan)
    # of the wells at that height only the one that the release is in
    barriers = steady.phi[~steady.stable]
    own_side = np.searchsorted(barriers, phi) == np.searchsorted(barriers, release.posed.phi)
    shown = [own.energy[0], *steady.energy[inside]]
    room = (max(shown) - min(shown)) * ROOM
    return panel(
        f"{release.name}: {what}",
        "phi [rad]",
        "V [m g R]",
        line("effective potential", phi, V),
        line("energy of the release", phi, np.where(own_side, reached, np.nan), 3),
        *_marked(steady, inside),
        points("release", own.phi, own.energy, 3),
        log_x=wide,
        y_range=(min(shown) - room, max(shown) + room),
    )


def _marked(steady: SteadyMotions, inside: NDArray[np.bool_]) -> tuple[Series, ...]:
    kinds = (STABLE, 2, steady.stable & inside), (UNSTABLE, 4, ~steady.stable & inside)
    return tuple(
        # drawn alike over the first integrals, where saddles are dashed
        points(label, steady.phi[which], steady.energy[which], kind, dashed=label == UNSTABLE)
        for label, kind, which in kinds
        if which.any()
    )


def _branches(release: Release) -> Panel:
    """Draw the steady motions over B_-2, the other first integral being that of the release."""
    can, (K, B) = release.posed.parameters, release.level
    phi = np.linspace(FLAT, UPRIGHT, NUTATION_SAMPLES)
    series = []
    for sheet in branches(can, phi, K):
        inside = (release.B[0] < sheet.B) & (release.B[1] > sheet.B)
        unstable = sheet.squared_eigenvalue > 0
        for label, kind, which in ((STABLE, 2, sheet.stable), (UNSTABLE, 4, unstable)):
            if (which & inside).any():
                drawn = where(which & inside, sheet.B)
                series.append(line(label, drawn, sheet.phi, kind, dashed=label == UNSTABLE))
    turning = folds_at(can, K)
    inside = (release.B[0] < turning.B) & (release.B[1] > turning.B)
    return panel(
        f"{release.name}: steady motions, K = {K:.3g}",
        "B_-2 [sqrt(g/R)]",
        "phi [rad]",
        *series,
        points("fold", turning.B[inside], turning.phi[inside], 5),
        points("release", np.array([B]), release.own.phi, 3),
        x_range=release.B,
    )


def _plane(release: Release) -> Panel:
    """Draw the folds in the plane of the first integrals, over how many wells there are."""
    phi = np.linspace(FLAT, UPRIGHT, NUTATION_SAMPLES)
    K, B = release.level
    left, right, low, high = release.plane
    return panel(
        f"{release.name}: wells and folds",
        "B_-2 [sqrt(g/R)]",
        "K [sqrt(g/R)]",
        *(
            line("fold", sign * sheet.B, sign * sheet.K, 5)
            for sheet in folds(release.posed.parameters, phi)
            for sign in (1.0, -1.0)
        ),
        points("release", np.array([B]), np.array([K]), 3),
        x_range=(left, right),
        y_range=(low, high),
        heat=_count(release),
    )


def _count(release: Release) -> Heatmap:
    """Count the wells of each level: where the slope of the potential turns from down to up."""
    left, right, low, high = release.plane
    x, y = np.linspace(left, right, CELLS + 1), np.linspace(low, high, CELLS + 1)
    phi = np.geomspace(1e-3, UPRIGHT, NUTATIONS)
    phi = np.union1d(phi, np.linspace(phi[0], UPRIGHT, NUTATIONS))[:, None, None]
    B, K = np.meshgrid((x[1:] + x[:-1]) / 2, (y[1:] + y[:-1]) / 2)
    own, mixed, other, gravity = (
        part[:, None, None] for part in force_form(release.posed.parameters, phi[:, 0, 0])
    )
    up = (own * K**2 + mixed * K * B + other * B**2 + gravity) < 0
    wells = (up[1:] & ~up[:-1]).sum(axis=0)
    return Heatmap(label="wells [number]", x=x, y=y, z=wells.astype(float))
