"""Effective potential, steady motions and their folds: where a can has two wells to rock in."""

from dataclasses import dataclass

import numpy as np

from harness.artefact import Figure, Floats, Panel, Series
from harness.studies.gallery.release import (
    FIFTH_CURVE,
    FOURTH_CURVE,
    OURS,
    PHI,
    PSI_DOT,
    SECOND,
    SECOND_CURVE,
    THETA_DOT,
    THIRD_CURVE,
    line,
    points,
    where,
)
from reference import PAPER_CAN, Parameters
from reference.bifurcation import (
    SteadyMotions,
    branches,
    effective_potential,
    folds,
    states_at,
    steady_motions,
)

SAMPLES = 4000
FLAT, UPRIGHT = 1e-2, np.pi / 2
WIDEST = 0.02
"""Room beside a zoomed well, as a share of its width."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Release:
    """A can at rest in phi, and what is drawn of it.

    Parameters
    ----------
    name : str
    parameters : Parameters
    phi, psi_dot, theta_dot : float
        Dimensionless.
    zoom : tuple of 2 floats
        Nutations between which the well of the release is drawn large.
    """

    name: str
    parameters: Parameters
    phi: float
    psi_dot: float
    theta_dot: float
    zoom: tuple[float, float]

    @property
    def own(self) -> SteadyMotions:
        """The first integrals and the energy of the release, shapes (1,)."""
        return states_at(
            self.parameters, *(np.array([x]) for x in (self.phi, self.psi_dot, self.theta_dot))
        )


RELEASES = (
    Release(
        name="two wells",
        parameters=Parameters(a=0.2919, c=0.3791, h=0.5575),
        phi=1.5026354274572624,
        psi_dot=-0.39236159644870505,
        theta_dot=-1.0199477967008015,
        zoom=(1.40, 1.54),
    ),
    Release(
        name="the paper's release",
        parameters=PAPER_CAN,
        phi=PHI,
        psi_dot=PSI_DOT * SECOND,
        theta_dot=THETA_DOT * SECOND,
        zoom=(1e-4, 5e-2),
    ),
)


def wells() -> Figure:
    """Two cans, one with a second well: potential, its well, steady motions, folds."""
    rows = zip(*(_panels(release) for release in RELEASES), strict=True)
    upper, paper = RELEASES
    known = steady_motions(upper.parameters, *_level(upper))
    barrier = float(known.energy[1] - upper.own.energy[0])
    return Figure(
        name="wells",
        title="Effective potential, steady motions and their folds",
        seen=(
            f"Left, a = {upper.parameters.a}, c = {upper.parameters.c}, h = {upper.parameters.h}: "
            f"{known.phi.size} steady motions on the level of the release, centres at phi = "
            f"{known.phi[0]:.3f} and {known.phi[2]:.3f} and a saddle between them at "
            f"{known.phi[1]:.3f}. Released at {upper.phi:.3f} the can stays in the upper well, "
            f"under a barrier that is {barrier:.1e} m g R above its energy. Right, the paper's "
            f"can and release: one well, whose centre lies at phi = "
            f"{steady_motions(paper.parameters, *_level(paper)).phi[0]:.2e}."
        ),
        panels=tuple(panel for row in rows for panel in row),
        columns=2,
    )


def _level(release: Release) -> tuple[float, float]:
    return float(release.own.K[0]), float(release.own.B[0])


def _panels(release: Release) -> tuple[Panel, ...]:
    return (
        _potential(release, (FLAT, UPRIGHT), "effective potential"),
        _potential(release, release.zoom, "the well of the release"),
        _branches(release),
        _plane(release),
    )


def _potential(release: Release, ends: tuple[float, float], what: str) -> Panel:
    """The potential between two nutations, with what rests there and the energy of the release."""
    can, own = release.parameters, release.own
    K, B = _level(release)
    wide = ends[1] / ends[0] > 1 / FLAT
    space = np.geomspace if wide else np.linspace
    phi = space(*ends, SAMPLES)
    V = effective_potential(can, phi, K, B)
    steady = steady_motions(can, K, B)
    inside = (steady.phi > ends[0]) & (steady.phi < ends[1])
    reached = np.where(V <= own.energy[0], own.energy[0], np.nan)
    # of the wells at that height only the one that the release is in
    barriers = steady.phi[~steady.stable]
    own_side = np.searchsorted(barriers, phi) == np.searchsorted(barriers, release.phi)
    shown = [own.energy[0], *steady.energy[inside]]
    room = (max(shown) - min(shown)) * 0.35
    return Panel(
        title=f"{release.name}: {what}",
        x_label="phi [rad]",
        y_label="V [m g R]",
        series=(
            line("effective potential", phi, V, OURS),
            line("energy of the release", phi, np.where(own_side, reached, np.nan), SECOND_CURVE),
            *_marked(steady, inside),
            points("release", own.phi, own.energy, FIFTH_CURVE),
        ),
        log_x=wide,
        y_range=(min(shown) - room, max(shown) + room),
    )


def _marked(steady: SteadyMotions, inside: Floats) -> tuple[Series, ...]:
    made = []
    for label, which, kind in (
        ("stable steady motion", steady.stable & inside, THIRD_CURVE),
        ("unstable steady motion", ~steady.stable & inside, FOURTH_CURVE),
    ):
        if which.any():
            made.append(points(label, steady.phi[which], steady.energy[which], kind))
    return tuple(made)


def _branches(release: Release) -> Panel:
    """Steady motions over B_-2, the other first integral being that of the release."""
    K, B = _level(release)
    phi = np.linspace(FLAT, UPRIGHT, SAMPLES)
    series = []
    for sheet in branches(release.parameters, phi, K):
        for label, which, kind, dashed in (
            ("stable steady motion", sheet.stable, THIRD_CURVE, False),
            ("unstable steady motion", sheet.squared_eigenvalue > 0, FOURTH_CURVE, True),
        ):
            series.append(line(label, where(which, sheet.B), sheet.phi, kind, dashed=dashed))
    return Panel(
        title=f"{release.name}: steady motions at K = {K:.3g}",
        x_label="B_-2 [sqrt(g/R)]",
        y_label="phi [rad]",
        series=(*series, points("release", np.array([B]), release.own.phi, FIFTH_CURVE)),
    )


def _plane(release: Release) -> Panel:
    """The folds in the plane of the first integrals."""
    phi = np.linspace(FLAT, UPRIGHT, SAMPLES)
    series = []
    for sheet in folds(release.parameters, phi):
        for sign in (1.0, -1.0):
            series.append(line("fold", sign * sheet.B, sign * sheet.K, OURS))
    K, B = _level(release)
    return Panel(
        title=f"{release.name}: folds",
        x_label="B_-2 [sqrt(g/R)]",
        y_label="K [sqrt(g/R)]",
        series=(*series, points("release", np.array([B]), np.array([K]), FIFTH_CURVE)),
    )
