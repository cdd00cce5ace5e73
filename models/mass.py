"""The can and its point mass as one rigid body: mass, centre of mass and moments about it.

By Steiner's rule, with the masses m of the can and n of the point at p from the can's centre:
M = m + n, c = n p/M, and I = I_can + (m n/M)(p.p 1 - p p^T), since the two centres of mass are p
apart.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.scene import Scene


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Body:
    """A rigid body in axes fixed to the can, z along its symmetry axis.

    Parameters
    ----------
    mass : float
        kg.
    centre : ndarray, shape (3,)
        The centre of mass from the centre of the can, m.
    inertia : ndarray, shape (3, 3)
        About the centre of mass, kg m^2.
    """

    mass: float
    centre: NDArray[np.float64]
    inertia: NDArray[np.float64]

    def principal(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the principal moments, shape (3,), and the axes as columns, shape (3, 3).

        The axes are right-handed, and each is as near as can be to the can's axis of its place.
        """
        moments, axes = np.linalg.eigh(self.inertia)
        order = [-1, -1, -1]
        likeness = np.abs(axes)
        for _ in range(3):
            row, column = np.unravel_index(int(np.argmax(likeness)), likeness.shape)
            order[int(row)] = int(column)
            likeness[row, :] = likeness[:, column] = -1.0
        moments, axes = moments[order], axes[:, order]
        axes = axes * np.where(np.diagonal(axes) < 0.0, -1.0, 1.0)
        if np.linalg.det(axes) < 0.0:
            axes[:, int(np.argmin(np.diagonal(axes)))] *= -1.0
        return moments, axes


def body(scene: Scene) -> Body:
    """Return the rigid body of a scene's can, with its point mass if it has one."""
    can, point = scene.can, scene.effects.point_mass
    own = np.diag((can.transverse_inertia, can.transverse_inertia, can.axial_inertia))
    if point is None:
        return Body(mass=can.mass, centre=np.zeros(3), inertia=own)
    mass = can.mass + point.mass
    place = np.array((point.x, point.y, point.z))
    steiner = place @ place * np.eye(3) - np.outer(place, place)
    return Body(
        mass=mass,
        centre=point.mass / mass * place,
        inertia=own + can.mass * point.mass / mass * steiner,
    )
