"""Scenes of any hardness: the same can, its spin turned up or down; and how cost goes with it.

The small parameter of the paper, epsilon = B_{-2}^2 (a_p + 1), is read off the exact motion: its
bounce comes as near to flat as phi_min = sqrt(epsilon a_p/((a_p + 1) I)), with I/2 the largest phi
(eq01:phi_inner; the paper's 1.43e-10 has the factor a_p + 1, see `reference.asymptotic.matched`).
Psi' and theta' at release are multiplied by one factor, and epsilon goes with its square.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from scipy.stats import linregress
from scipy.stats import t as student

from harness.core.report_model import Figure, Panel, Series
from harness.engines.reference.truth import truth
from models.scene import Horizon, Scene

_ROUNDS = 6
"""Of regula falsi in logarithms, each a digit or more: epsilon is nearly a power of the factor."""

_NEAR = 0.02
"""Of epsilon, by which a scene may miss the one asked for."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Exponent:
    """Cost ~ epsilon^exponent; half-width of the 95 % interval, infinite for two points."""

    exponent: float
    confidence: float
    points: int


def epsilon(scene: Scene) -> float | None:
    """Return the paper's small parameter of a scene, or None if its can does not bounce."""
    bounces = truth(scene).bounces
    if not bounces:
        return None
    can = scene.can
    a_p = can.a + can.h**2
    largest = max(scene.release.phi, bounces[0].phi_min)
    return (a_p + 1.0) / a_p * 2.0 * largest * bounces[0].phi_min ** 2


def hardened(scene: Scene, wanted: float) -> Scene | None:
    """Return the scene with its spin changed so that epsilon is as wanted, for one bounce.

    Returns
    -------
    Scene or None
        None if no such spin is found: a can that stands upright does not bounce gently.
    """
    own = epsilon(scene)
    if own is None or own == 0.0:
        return None
    factor = math.sqrt(wanted / own)
    for _ in range(_ROUNDS):
        made = _spun(scene, factor, wanted)
        found = epsilon(made)
        if found is None or not 0.0 < found < math.inf:
            return None
        if abs(found / wanted - 1.0) < _NEAR:
            return made
        factor *= math.sqrt(wanted / found)
    return None


def _spun(scene: Scene, factor: float, wanted: float) -> Scene:
    release = scene.release
    return replace(
        scene,
        name=f"{scene.name}-epsilon-1e{round(math.log10(wanted))}",
        cite=f"{scene.name} with psi' and theta' multiplied by {factor:.6g}",
        release=replace(
            release, psi_dot=release.psi_dot * factor, theta_dot=release.theta_dot * factor
        ),
        horizon=Horizon(bounces=1),
    )


def exponent(epsilons: Sequence[float], costs: Sequence[float]) -> Exponent | None:
    """Return the exponent of cost against epsilon, by least squares in logarithms; None of one."""
    pairs = [(e, c) for e, c in zip(epsilons, costs, strict=True) if c > 0.0 and math.isfinite(c)]
    if len(pairs) < 2:  # noqa: PLR2004 - a slope needs two points
        return None
    fit = linregress(*np.log(np.array(pairs)).T)
    freedom = len(pairs) - 2
    width = float(student.ppf(0.975, freedom) * fit.stderr) if freedom else math.inf
    return Exponent(exponent=float(fit.slope), confidence=width, points=len(pairs))


def hardness_figure(
    scene: str, degree: pd.DataFrame, growth: pd.DataFrame, costs: tuple[float, float]
) -> Figure:
    """Return the cost of a degree against epsilon.

    Parameters
    ----------
    scene : str
    degree, growth : DataFrame
        What a degree costs at each hardness, and the exponents of that.
    costs : tuple of 2 floats
        Ends of the axis of costs.
    """
    series = tuple(
        Series(
            label=f"{name}, {steps}",
            kind=str(name),
            x=own["epsilon"].to_numpy(dtype=np.float64),
            y=own["cost_s_s"].to_numpy(dtype=np.float64),
            mark="both",
            dashed=steps != "fixed step",
            hover=tuple("at most" if bound else "one degree" for bound in own["at_most"]),
        )
        for (name, steps), own in degree.groupby(["engine", "steps"], sort=False)
    )
    told = "; ".join(
        f"{row.engine}, {row.steps}: {row.exponent:+.2f}" for row in growth.itertuples()
    )
    return Figure(
        name=f"{scene}-hardness",
        title="What one degree costs as the bounce gets harder",
        seen=(
            "From right to left the bounce gets harder, down to the paper's. Exponents of the cost "
            f"against epsilon: {told or 'none'}."
        ),
        panels=(
            Panel(
                title="Cost of one degree",
                x_label="epsilon",
                y_label="processor seconds per simulated second",
                series=series,
                log_x=True,
                log_y=True,
                x_range=(1e-11, 1e-3),
                y_range=costs,
            ),
        ),
        columns=1,
        scene=scene,
    )
