"""Releases in upper wells, beside separatrices and beside steady motions, over random cans.

On a branch of the closed subsystem, fixed by a steady motion, the effective potential is known as a
function of nutation: a release with the energy of choice is one of its levels.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from reference import Parameters
from reference.equations import steady_motion
from reference.integrable.frobenius import (
    can_constants,
    first_integrals,
    precession_and_spin,
    series_of,
)
from reference.problem.states import Floats

FAMILIES = ("upper well", "separatrix", "steady")
# Energies that doubles can hardly tell from a barrier's: a family of its own, one release in so
# many.
CLOSEST = "round-off of a separatrix"
RARE = 50
# Where potentials are looked at: log-spaced below, for the lower well lies there.
GRID = np.unique(np.concatenate([np.geomspace(1e-4, 1.57, 300), np.linspace(0.02, 1.57, 300)]))
# Of the energies beside a barrier, relative: from a tenth down to where an ulp of the numbers given
# decides the third digit, and from there down to round-off.
DECADES = {"separatrix": (1.0, 12.0), CLOSEST: (12.0, 16.0)}
# Steady motions of one can among which one is chosen.
STEADY = 32


@dataclass(frozen=True, slots=True, kw_only=True)
class Made:
    """One release."""

    family: str
    parameters: Parameters
    phi: float
    phi_dot: float
    psi_dot: float
    theta_dot: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Branch:
    """A branch (K, B) of one can."""

    parameters: Parameters
    K: Floats
    B: Floats

    def rates(self, phi: Floats) -> tuple[Floats, Floats]:
        """Precession rate and spin."""
        can = can_constants(self.parameters)
        return precession_and_spin(can, series_of(self.parameters), phi, self.K, self.B)

    def potential(self, phi: Floats) -> Floats:
        """Effective potential: the energy without that of nutation."""
        p, (Psi, spin) = self.parameters, self.rates(phi)
        S, C = np.sin(phi), np.cos(phi)
        q = S * Psi
        w = spin - Psi * (1 - C)
        return np.asarray((p.a * q**2 + p.c * w**2 + (w - p.h * q) ** 2) / 2 + S + p.h * C)


def made(numbers: range, seed: int) -> Iterator[Made]:
    """Yield the releases of these numbers, the families in turn; each has its own generator."""
    for number in numbers:
        rng = np.random.default_rng([seed, number])
        family = FAMILIES[number % len(FAMILIES)]
        if number % RARE == RARE - 1:
            family = CLOSEST
        while (found := _try(family, rng)) is None:
            pass
        yield found


def _try(family: str, rng: np.random.Generator) -> Made | None:
    """Construct a release, if a steady motion of a random can allows it."""
    a = 10.0 ** rng.uniform(-1.5, 1.0)
    c = 2 * a if rng.random() < 0.1 else a * rng.uniform(0.02, 2.0)
    can = Parameters(a=a, c=min(c, 2 * a), h=10.0 ** rng.uniform(-2.0, 1.0))
    phi = rng.uniform(0.03, 1.55, STEADY)
    psi_dot = rng.choice([-1, 1], STEADY) * 10.0 ** rng.uniform(-1.5, 0.7, STEADY)
    theta_dot = np.array(
        [steady_motion.steady_rotation(can, *at) for at in zip(phi, psi_dot, strict=True)]
    )
    K, B = first_integrals(can_constants(can), series_of(can), phi, psi_dot, psi_dot + theta_dot)
    V = Branch(parameters=can, K=K, B=B).potential(GRID[:, None])
    at = np.searchsorted(GRID, phi)
    inner = np.arange(GRID.size)[1:-1, None]
    tops = (V[1:-1] > V[:-2]) & (V[1:-1] > V[2:])
    beside = np.abs(inner - at) <= 1
    # a maximum of the potential on the steady motion itself, or between it and the flat state
    saddle, above = (tops & beside).any(axis=0), (tops & (inner < at - 1)).any(axis=0)
    wanted = {"upper well": above & ~saddle, "steady": at > 0}.get(family, saddle)
    if not wanted.any():
        return None
    one = int(rng.choice(np.flatnonzero(wanted)))
    branch = Branch(parameters=can, K=K[one : one + 1], B=B[one : one + 1])
    place = float(phi[one])
    if family == "steady":
        return _beside(family, branch, place, rng)
    height = float(branch.potential(np.array([place]))[0])
    if family == "upper well":
        # the nearest barrier below
        barrier = float(V[1:-1, one][tops[:, one] & (inner[:, 0] < at[one] - 1)][-1])
        energy = height + rng.uniform(0.01, 1.5) * (barrier - height)
    else:
        energy = height * (
            1 + float(rng.choice([-1.0, 1.0])) * 10.0 ** -rng.uniform(*DECADES[family])
        )
    return _at_energy(family, branch, place, energy, rng)


def _beside(family: str, branch: Branch, phi: float, rng: np.random.Generator) -> Made | None:
    """Release a little off a steady motion, at rest or moving."""
    off = float(rng.choice([-1, 1]) * 10.0 ** rng.uniform(-12.0, -1.0))
    place, phi_dot = phi * (1 + off), 0.0
    if rng.random() < 0.5:
        place, phi_dot = phi, off
    return _made(family, branch, place, phi_dot)


def _at_energy(
    family: str, branch: Branch, near: float, energy: float, rng: np.random.Generator
) -> Made | None:
    """Release with an energy: at rest where the potential has that level, or moving elsewhere."""
    V = branch.potential(GRID) - energy
    if rng.random() < 0.3:
        room = np.flatnonzero(V < 0)
        if not room.size:
            return None
        place = float(GRID[rng.choice(room)])
        left = float(energy - branch.potential(np.array([place]))[0])
        rate = float(np.sqrt(2 * left / branch.parameters.pendulum_inertia))
        return _made(family, branch, place, float(rng.choice([-1, 1])) * rate)
    crossings = np.flatnonzero(V[1:] * V[:-1] < 0)
    if not crossings.size:
        return None
    nearest = crossings[np.abs(GRID[crossings] - near).argsort()[:3]]
    at = int(rng.choice(nearest))
    place = brentq(
        lambda x: float(branch.potential(np.array([x]))[0]) - energy,
        GRID[at],
        GRID[at + 1],
        xtol=1e-16,
    )
    return _made(family, branch, float(place), 0.0)


def _made(family: str, branch: Branch, phi: float, phi_dot: float) -> Made | None:
    if not 0 < phi < np.pi / 2:
        return None
    Psi, spin = branch.rates(np.array([phi]))
    return Made(
        family=family,
        parameters=branch.parameters,
        phi=phi,
        phi_dot=phi_dot,
        psi_dot=float(Psi[0]),
        theta_dot=float(spin[0] - Psi[0]),
    )
