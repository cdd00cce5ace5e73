"""Made-up colliders of a can on a plane: an exact one, and those with the traps of real ones."""

from typing import Any

import numpy as np

from harness.core.case import Case
from harness.engines.base import Setting, Variant
from harness.engines.description import Description, Precision
from harness.engines.world import Collision, Floats
from models import Can, Pose, Twist

MIDDLE_BELOW = 4.472136e-4
"""rad: |cos - 1| < 1e-7."""

FOUR_BELOW = 1.25e-6
"""rad."""

COLLIDERS = (
    *("exact", "middle", "four", "ends", "polygon", "sinking", "leaning", "broken", "small"),
    *("surface", "no direction"),
)

_ENDS, _SMALL = 100.0, 1e-2  # m


class RimWorld:
    """A can that can be placed and asked, and does not move.

    Parameters
    ----------
    can : Can
    kind : str
        One of `COLLIDERS`.
    """

    timestep = 1e-3

    def __init__(self, can: Can, kind: str) -> None:
        self._can, self._kind = can, kind
        self._centre, self._axis = np.zeros(3), np.zeros(3)

    def place(self, pose: Pose, _: Twist) -> None:
        """Put the can somewhere."""
        w, x, y, z = pose.quaternion.tolist()
        upright = w * w + z * z - x * x - y * y
        axis = np.array((2.0 * (x * z + w * y), 2.0 * (y * z - w * x), upright))
        self._centre = pose.position
        self._axis = axis if upright >= 0.0 else -axis  # both ends are alike

    def collision(self) -> Collision:
        """Return the contact points."""
        points = np.array(self._candidates())
        if self._kind == "four":  # all as deep as the lowest
            points[:, 2] = points[0, 2]
        if self._kind == "broken":
            points[:] = np.nan
        if self._kind == "small" and self._can.radius < _SMALL:
            points[:, 0] += 0.1 * self._can.radius
        if self._kind == "ends" and abs(self._centre[0]) > _ENDS:
            points = points[:0]
        normal = (1e-2, 0.0, 1.0) if self._kind == "leaning" else (0.0, 0.0, 1.0)
        normals = np.tile(normal, (len(points), 1)) * float(self._kind != "no direction")
        deeper = 2e-3 * self._can.radius if self._kind == "sinking" else 0.0
        depths = deeper - points[:, 2]
        if self._kind == "surface":  # has no depth, and is there where it touches
            points, normals = points[depths > 0.0], normals[depths > 0.0]
            depths = np.full(len(points), np.nan)
        return Collision(points=points, normals=normals, depths=depths)

    def _candidates(self) -> list[Floats]:
        level = np.append(self._axis[:2], 0.0)
        tilt = float(np.arctan2(np.linalg.norm(level), self._axis[2]))
        along = level / np.linalg.norm(level)
        base = self._centre - self._can.half_height * self._axis
        if self._kind == "middle" and tilt < MIDDLE_BELOW:
            return [base]
        azimuth = np.arctan2(along[1], along[0])
        if self._kind == "polygon":
            side = np.pi / 16.0
            azimuth = side * np.round(azimuth / side)
        turns = [0.0]
        if self._kind == "four" and tilt < FOUR_BELOW:
            turns = [0.0, 0.5 * np.pi, np.pi, 1.5 * np.pi]
        return [base + self._can.radius * self._rim(azimuth + turn, tilt, along) for turn in turns]

    @staticmethod
    def _rim(azimuth: float, tilt: float, along: Floats) -> Floats:
        """Return the unit vector from the middle of the base to its rim at an azimuth."""
        towards = np.arctan2(along[1], along[0])
        near, beside = np.cos(azimuth - towards), np.sin(azimuth - towards)
        across = np.array((-along[1], along[0], 0.0))
        steepest = np.cos(tilt) * along - np.sin(tilt) * np.array((0.0, 0.0, 1.0))
        point: Floats = near * steepest + beside * across
        return point


class MadeUpEngine:
    """An engine of which only the collider is there."""

    name, version = "made-up", "1"
    description = Description(precision=Precision.DOUBLE)
    settings = (Setting.as_shipped("collider", "exact", "Which collider.", choices=COLLIDERS),)
    colliders = tuple(Variant(name=word, settings=(("collider", word),)) for word in COLLIDERS)

    def timestep(self, _: Case) -> float:
        """Return the timestep of a case, s."""
        return RimWorld.timestep

    def open(self, case: Case) -> Any:
        """Return the world of a case."""
        return RimWorld(case.scene.can, str(dict(case.options).get("collider", "exact")))
