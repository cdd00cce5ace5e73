"""Conventions of other programs, and the way from theirs to ours.

Ours: the plane is z = 0 with z up, and axes are right-handed; the quaternion turns the body into
the world, and the body's z runs along the can, from the base up; the position is that of the centre
of the can. With S the rotation of a program's world and T that of its body that bring its axis up,
and its axis of the can, to z,

    R_WB = S R T^-1,    p = S p',    omega = S omega'

and a left-handed program is seen in a mirror first, which turns y about: of the quaternion the
components x and z change their signs, as those of an angular velocity do.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import product
from types import MappingProxyType

import numpy as np

from harness.core.errors import InvalidSettingError
from harness.core.trajectory import Floats

AXES = ("z", "y", "x", "-z", "-y", "-x")

CHOICES = MappingProxyType(
    {
        "up": AXES,
        "hand": ("right", "left"),
        "axis": AXES,
        "quaternion": ("body-to-world", "world-to-body"),
        "order": ("wxyz", "xyzw"),
        "origin": ("centre", "base"),
        "spin": ("world", "body"),
    }
)
"""Words of each part of a convention, ours first."""

MEANINGS = MappingProxyType(
    {
        "up": "axis of the world that points up",
        "hand": "whether the axes are those of the right hand",
        "axis": "axis of the body along the can, from its base up",
        "quaternion": "what the quaternion turns into what",
        "order": "whether qw, qx, qy, qz hold these, or x, y, z, w",
        "origin": "whether the position is that of the can's centre or of its base's",
        "spin": "axes in which the angular velocity is given",
    }
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Convention:
    """How a program writes positions and orientations; every field is a word of `CHOICES`."""

    up: str = "z"
    hand: str = "right"
    axis: str = "z"
    quaternion: str = "body-to-world"
    order: str = "wxyz"
    origin: str = "centre"
    spin: str = "world"

    def parts(self) -> dict[str, str]:
        """Return the word of each part."""
        return {name: getattr(self, name) for name in CHOICES}

    def sentence(self) -> str:
        """Return the convention in words."""
        return ", ".join(f"{name} {word}" for name, word in self.parts().items())


def chosen_parts(pairs: Iterable[str]) -> dict[str, str]:
    """Return the parts of a convention that were given, PART=WORD each.

    Raises
    ------
    InvalidSettingError
        If there is no such part or word.
    """
    chosen: dict[str, str] = {}
    for pair in pairs:
        part, equals, word = pair.partition("=")
        if not equals or part not in CHOICES:
            allowed = ", ".join(f"{name}=..." for name in CHOICES)
            raise InvalidSettingError("--convention", pair, allowed)
        if word not in CHOICES[part]:
            raise InvalidSettingError(f"--convention {part}", word, ", ".join(CHOICES[part]))
        chosen[part] = word
    return chosen


def conventions(given: dict[str, str], *, angles: bool) -> Iterator[Convention]:
    """Yield the conventions that have the given parts, ours first.

    Parameters
    ----------
    given : dict of str to str
    angles : bool
        Whether orientations are the paper's angles, which have a convention of their own.
    """
    fixed = {"hand", "axis", "quaternion", "order"} if angles else set()
    free = {
        part: (given[part],) if part in given else words[:1] if part in fixed else words
        for part, words in CHOICES.items()
        if part != "spin"  # that is told from the angular velocity, once the rest is known
    }
    for words in product(*free.values()):
        yield Convention(**dict(zip(free, words, strict=True)), spin=given.get("spin", "world"))


_HALF = math.sqrt(0.5)

_TO_Z = MappingProxyType(
    {
        "z": (1.0, 0.0, 0.0, 0.0),
        "-z": (0.0, 1.0, 0.0, 0.0),
        "y": (_HALF, _HALF, 0.0, 0.0),
        "-y": (_HALF, -_HALF, 0.0, 0.0),
        "x": (_HALF, 0.0, -_HALF, 0.0),
        "-x": (_HALF, 0.0, _HALF, 0.0),
    }
)
"""Quaternions, scalar first, that bring an axis to z."""


def multiplied(first: Floats, second: Floats) -> Floats:
    """Return the product of quaternions, scalar first, shapes (..., 4): the second turn first."""
    a, b = first[..., :1], second[..., :1]
    u, v = first[..., 1:], second[..., 1:]
    scalar = a * b - np.sum(u * v, axis=-1, keepdims=True)
    return np.concatenate((scalar, a * v + b * u + np.cross(u, v)), axis=-1)


def turned(quaternion: Floats, vectors: Floats) -> Floats:
    """Return vectors turned by a quaternion, scalar first, shapes (4,) or (n, 4) and (n, 3)."""
    axis = quaternion[..., 1:]
    twice = 2.0 * np.cross(axis, vectors)
    result: Floats = vectors + quaternion[..., :1] * twice + np.cross(axis, twice)
    return result


_MIRRORED = np.array((1.0, -1.0, 1.0))
_TURNED_ABOUT = np.array((-1.0, 1.0, -1.0))
"""Signs of a vector in the mirror of y, and of an axis of rotation."""


def vector_from(convention: Convention, vectors: Floats, *, axial: bool = False) -> Floats:
    """Return vectors of a program's world in ours, shape (n, 3); `axial` for angular velocities."""
    own = vectors
    if convention.up != "z":
        own = turned(np.array(_TO_Z[convention.up]), own)
    if convention.hand == "left":
        own = own * (_TURNED_ABOUT if axial else _MIRRORED)
    return own


def body_vector_from(convention: Convention, vectors: Floats) -> Floats:
    """Return angular velocities in a program's axes of the body in ours, shape (n, 3)."""
    along = replace(convention, up=convention.axis)
    return vector_from(along, vectors, axial=True)


def quaternion_from(convention: Convention, quaternions: Floats) -> Floats:
    """Return a program's quaternions as ours, shape (n, 4), scalar first, without jumps of sign."""
    q = quaternions
    if convention.order == "xyzw":
        q = np.roll(q, 1, axis=-1)
    if convention.quaternion == "world-to-body":
        q = q * np.array((1.0, -1.0, -1.0, -1.0))
    if convention.up != "z":
        q = multiplied(np.array(_TO_Z[convention.up]), q)
    if convention.axis != "z":
        back = np.array(_TO_Z[convention.axis]) * np.array((1.0, -1.0, -1.0, -1.0))
        q = multiplied(q, np.broadcast_to(back, q.shape))
    if convention.hand == "left":
        q = q * np.concatenate(((1.0,), _TURNED_ABOUT))
    return continuous(q)


def continuous(quaternions: Floats) -> Floats:
    """Return quaternions with signs such that neighbours are near each other, shape (n, 4)."""
    against = np.sum(quaternions[1:] * quaternions[:-1], axis=-1) < 0.0
    signs = np.where(np.cumsum(against) % 2 == 1, -1.0, 1.0)
    return quaternions * np.concatenate(((1.0,), signs))[:, None]
