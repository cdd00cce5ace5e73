"""The states of a can at many instants."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from reference.problem.problem import Problem

Floats: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class States:
    """States on a grid of n instants; every field has shape (n,).

    Angles in rad, rates in sqrt(g/R), lengths in R. `spin` is psi' + theta': near the flat state
    each of the two rates is huge and their sum is not, so it is carried by itself; formulas that
    need the sum must use it and not add the rates. `x`, `y` locate the contact point, with the
    middle of the can above (0, 0) at release; they are None unless the contact locus was asked for.
    `slip`, shape (n, 2), is the velocity of the rim's material at the contact, and `force`, shape
    (n, 3), what the plane exerts on the can, in m g, both in the world; they are None where the rim
    never slips and the force follows from the angles (`reference.equations.reaction_force`). `gap`
    is the height of the lowest point of the rim above the plane, negative in one that gives way,
    and `rise` the upward velocity of the rim's material there; they are None of a model whose rim
    stays on the plane.
    """

    phi: Floats
    phi_dot: Floats
    psi: Floats
    psi_dot: Floats
    theta: Floats
    theta_dot: Floats
    spin: Floats
    x: Floats | None = None
    y: Floats | None = None
    slip: Floats | None = None
    force: Floats | None = None
    gap: Floats | None = None
    rise: Floats | None = None

    def with_contact(self, there: "States") -> "States":
        """Return these states with contact point, slip and force of others."""
        return States(
            phi=self.phi,
            phi_dot=self.phi_dot,
            psi=self.psi,
            psi_dot=self.psi_dot,
            theta=self.theta,
            theta_dot=self.theta_dot,
            spin=self.spin,
            x=there.x,
            y=there.y,
            slip=there.slip,
            force=there.force,
            gap=there.gap,
            rise=there.rise,
        )


def initial_states(problem: Problem) -> States:
    """State at release, shape (1,), without the contact point and the force of the plane."""
    p = problem
    angles = p.phi, p.phi_dot, p.psi, p.psi_dot, p.theta, p.theta_dot, p.psi_dot + p.theta_dot
    phi, phi_dot, psi, psi_dot, theta, theta_dot, spin = np.array(angles, dtype=float)[:, None]
    return States(
        phi=phi,
        phi_dot=phi_dot,
        psi=psi,
        psi_dot=psi_dot,
        theta=theta,
        theta_dot=theta_dot,
        spin=spin,
        slip=_slip(problem) if problem.effects.declared() else None,
    )


def _slip(problem: Problem) -> Floats:
    """Slip at release in the world, shape (1, 2)."""
    cos, sin, (ahead, aside) = np.cos(problem.psi), np.sin(problem.psi), problem.slip
    return np.array([[ahead * cos - aside * sin, ahead * sin + aside * cos]])


@dataclass(frozen=True, slots=True, kw_only=True)
class Snapshot:
    """The state at one instant; the fields of `States` as numbers."""

    phi: float
    phi_dot: float
    psi: float
    psi_dot: float
    theta: float
    theta_dot: float
    spin: float

    @classmethod
    def of(cls, problem: Problem) -> "Snapshot":
        """Return the release."""
        return cls(
            phi=problem.phi,
            phi_dot=problem.phi_dot,
            psi=problem.psi,
            psi_dot=problem.psi_dot,
            theta=problem.theta,
            theta_dot=problem.theta_dot,
            spin=problem.psi_dot + problem.theta_dot,
        )


def states_of(snapshots: Sequence[Snapshot]) -> States:
    """Stack snapshots, shape (n,)."""
    names = Snapshot.__slots__
    rows = np.array([[getattr(snapshot, name) for snapshot in snapshots] for name in names], float)
    return States(**dict(zip(names, rows, strict=True)))


def select_states(states: States, index: slice | NDArray[np.intp] | NDArray[np.bool_]) -> States:
    """Return some of the states."""
    return States(
        phi=states.phi[index],
        phi_dot=states.phi_dot[index],
        psi=states.psi[index],
        psi_dot=states.psi_dot[index],
        theta=states.theta[index],
        theta_dot=states.theta_dot[index],
        spin=states.spin[index],
        x=None if states.x is None else states.x[index],
        y=None if states.y is None else states.y[index],
        slip=None if states.slip is None else states.slip[index],
        force=None if states.force is None else states.force[index],
        gap=None if states.gap is None else states.gap[index],
        rise=None if states.rise is None else states.rise[index],
    )
