"""A compiled engine model as the harness sees it: `World`, which can be placed, stepped and read.

The probes of parity and of the rim, and the search for the static penetration, are written once,
against it.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from harness.core.public_paths import warn_renamed
from models.state import Pose, Twist

if TYPE_CHECKING:
    from collections.abc import Callable

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Contact:
    """The contact at one instant: weighted point (3,), force (3,) on the can, depth, count."""

    point: Floats
    force: Floats
    penetration: float
    count: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Collision:
    """The contact points that a collider finds at one instant, before anything is solved.

    A world may have a method `collision` that returns them without a step; until the next step its
    `contact` tells nothing. One whose ground ends has a property `ground_half_width`, m.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        m; on the can, on the ground, or between.
    normals : ndarray, shape (n, 3)
        Unit vectors towards the can; NaN where they are not told.
    depths : ndarray, shape (n,)
        m; negative of a point above the ground; NaN where they are not told.
    """

    points: Floats
    normals: Floats
    depths: Floats


NO_POINTS = Collision(points=np.empty((0, 3)), normals=np.empty((0, 3)), depths=np.empty(0))
"""What a collider finds of a can that touches nothing."""


class World(Protocol):
    """A compiled engine model: one can, one plane, and a timestep that can change between steps."""

    @property
    def mass(self) -> float:
        """Mass of the can, kg."""

    @property
    def inertia(self) -> Floats:
        """Principal moments in the order of the body's axes, shape (3,), kg m^2."""

    @property
    def timestep(self) -> float:
        """The timestep that was asked for, s."""

    def set_timestep(self, timestep: float) -> None:
        """Step by another length from now on, s."""

    def place(self, pose: Pose, twist: Twist) -> None:
        """Put the can somewhere, moving; forget what was before."""

    def step(self) -> None:
        """Advance by one timestep."""

    def pose(self) -> Pose:
        """Return where the can is."""

    def twist(self) -> Twist:
        """Return how the can moves."""

    def contact(self) -> Contact:
        """Return the contact that the last step solved: that of the state before it."""

    def signed_distance(self) -> float:
        """Return the signed distance from the collider of the can to the plane, m."""


def signed_distance(world: World) -> float:
    """Return the signed distance of a world, m; one of the previous release calls it `gap`."""
    distance: Callable[[], float] | None = getattr(world, "signed_distance", None)
    if distance is None:
        warn_renamed(renamed_words(type(world).__name__, "gap", "signed_distance"))
        distance = world.gap  # type: ignore[attr-defined]
    return distance()


def renamed_words(owner: str, old: str, new: str) -> str:
    """Return what is said of an attribute under its name of the previous release."""
    return f"`{old}` of {owner} is now `{new}`; the old name goes with the next release"
