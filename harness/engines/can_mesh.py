"""A mesh that stands for the can in a collider: a prism, or one from a file.

It is a tuple of coordinates x, y, z of its points in turn, x and y in radii of the can and z in its
half heights, so that the same mesh fits every can and is known by its content. Colliders take its
convex hull.
"""

import math
from itertools import chain
from pathlib import Path
from typing import TypeAlias

import numpy as np
import scipy

from harness.core.engine_packages import install_command
from harness.core.errors import InvalidSettingError, MissingPackageError
from harness.core.trajectory import Floats, Integers
from harness.engines.base import Setting
from models import Can

Mesh: TypeAlias = tuple[float, ...]

MESH_SETTING = Setting.as_shipped(
    "mesh",
    None,
    "Points whose hull stands for the can: x and y in its radii, z in its half heights.",
    unset="the can's cylinder",
    points=True,
)
"""The harness's own word, for engines that take a mesh; `read_mesh` makes its value of a file."""

_MOST_POINTS = 5000
"""Of a hull."""

_FLAT = 1e-6
"""Of the half height: points that are as near to an end lie in it; and of the size: a mesh that is
as thin has no volume."""

_ROUND = 0.05
"""Of the radius: corners of an outline that are farther from a circle make no can."""

_EVEN = 0.8
"""Of the inner radius of a polygon with as many equal sides: what has less is drawn out."""

_LEAST_END = 0.6
"""Of the radius: a triangle lacks a half in the middle of its sides, and a can that lies more."""

_DIMENSIONS = 3


def prism(sides: int) -> Mesh:
    """Return a prism with its corners on the rims, the first on the axis x."""
    azimuths = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.array((np.cos(azimuths), np.sin(azimuths))).T
    ends = [np.insert(ring, 2, end, axis=1) for end in (-1.0, 1.0)]
    return _as_mesh(np.concatenate(ends))


def read_mesh(path: Path) -> Mesh:
    """Return the mesh of a file, such as OBJ or STL, whose axis of z is the can's.

    It is scaled to the can, along the axis and across it, and may be anywhere, in any unit.

    Raises
    ------
    InvalidSettingError
        If the file is no mesh of triangles, not a closed one, or not one of a can.
    MissingPackageError
        Without the package that reads meshes.
    """
    try:
        import trimesh  # noqa: PLC0415 - an extra
    except ImportError as error:
        install = install_command(["rockingcan[mesh]"])
        raise MissingPackageError("a mesh", "trimesh", str(error), install) from error
    if not path.is_file():
        raise _refused(path, "the path of a file")
    try:
        mesh = trimesh.load_mesh(path, process=False)
    except OSError as error:
        raise _refused(path, f"a file that can be read ({error.strerror or error})") from error
    except Exception as error:  # every format has errors of its own
        raise _refused(path, "a mesh in a known format, such as OBJ, STL or PLY") from error
    if not len(mesh.faces) or not np.isfinite(mesh.vertices).all():
        raise _refused(path, "a mesh of triangles, of finite coordinates")
    mesh.vertices, low, size = _in_a_unit_box(path, np.asarray(mesh.vertices, dtype=np.float64))
    mesh.merge_vertices()  # STL has three for every triangle
    edges, triangles = np.unique(mesh.edges_sorted, axis=0, return_counts=True)
    alone = edges[triangles == 1]
    if len(alone):
        ends = " to ".join(_spell(low + size * mesh.vertices[end]) for end in alone[0])
        allowed = f"a closed mesh; {len(alone)} edges have one triangle alone, such as from {ends}"
        raise _refused(path, allowed)
    if not mesh.is_watertight:
        raise _refused(path, "a closed mesh, with two triangles at every edge")
    if mesh.body_count > 1:
        raise _refused(path, f"a mesh of one body, and it has {mesh.body_count}")
    return _normalised(path, np.asarray(mesh.vertices, dtype=np.float64))


def _in_a_unit_box(path: Path, points: Floats) -> tuple[Floats, Floats, float]:
    """Return points in a box of size 1 at the origin, where they were, and their size."""
    half = 0.5 * points  # of which every difference is finite
    low = half.min(axis=0)
    size = float((half - low).max())
    if size > 0.0:
        scaled: Floats = (half - low) / size
        # in one plane, or so far away that their digits do not tell them apart
        if np.linalg.matrix_rank(scaled - scaled[0], tol=_FLAT) == _DIMENSIONS:
            return scaled, 2.0 * low, 2.0 * size
    raise _refused(path, "a mesh with a volume")


def _normalised(path: Path, points: Floats) -> Mesh:
    """Return the corners of the hull of some points, about the axis, of radius and half height 1.

    Raises
    ------
    InvalidSettingError
        If they are no can: not on a circle about the axis, or without ends.
    """
    hull = points[np.sort(scipy.spatial.ConvexHull(points).vertices)]
    if len(hull) > _MOST_POINTS:
        raise _refused(path, f"a mesh whose hull has {_MOST_POINTS} corners at most")
    low, high = hull[:, 2].min(), hull[:, 2].max()
    hull[:, 2] = (2.0 * hull[:, 2] - low - high) / (high - low)
    outline = hull[scipy.spatial.ConvexHull(hull[:, :2]).vertices, :2]
    # the circle x^2 + y^2 = 2 c.x + d that is nearest to the outline
    sides = np.column_stack((2.0 * outline, np.ones(len(outline))))
    circle, *_ = np.linalg.lstsq(sides, np.sum(outline**2, axis=1), rcond=None)
    hull[:, :2] -= circle[:2]
    distances = np.hypot(*(outline - circle[:2]).T)
    hull[:, :2] /= distances.max()
    mesh = _as_mesh(hull)
    inner = _inner_radius(outline - circle[:2]) / distances.max()
    regular = math.cos(math.pi / len(outline))
    on_circle = distances.min() >= (1.0 - _ROUND) * distances.max()
    if not on_circle or inner < _EVEN * regular or outline_gap(mesh) > _LEAST_END:
        raise _refused(
            path, "a mesh of a can with its axis along z: round about it, with flat ends"
        )
    return mesh


def mesh_points(mesh: Mesh, can: Can) -> Floats:
    """Return the points of a mesh on a can, shape (n, 3), m from its centre."""
    sizes = can.radius, can.radius, can.half_height
    points: Floats = np.reshape(mesh, (-1, 3)) * sizes
    return points


def hull_triangles(points: Floats) -> Integers:
    """Return the triangles of the convex hull of some points, shape (m, 3), seen from outside."""
    hull = scipy.spatial.ConvexHull(points)
    first, second, third = points[hull.simplices].transpose(1, 0, 2)
    outward = np.einsum("ij,ij->i", np.cross(second - first, third - first), hull.equations[:, :3])
    triangles: Integers = hull.simplices.astype(np.int64)
    triangles[outward < 0.0] = triangles[outward < 0.0, ::-1]
    return triangles


def obj_text(points: Floats) -> str:
    """Return the convex hull of some points, m, as a file in the format OBJ."""
    corners = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
    sides = [f"f {a} {b} {c}" for a, b, c in (hull_triangles(points) + 1).tolist()]
    return "\n".join((*corners, *sides, ""))


def outline_gap(mesh: Mesh) -> float:
    """Return by how much the outline of an end is within the rim at most, of the radius.

    1 if an end is not flat.
    """
    points = np.reshape(mesh, (-1, 3))
    least = 1.0
    for end in (-1.0, 1.0):
        outline = points[abs(points[:, 2] - end) < _FLAT, :2]
        if len(outline) < 3:  # noqa: PLR2004 - corners of a triangle
            return 1.0
        least = min(least, _inner_radius(outline))
    return 1.0 - least


def _inner_radius(outline: Floats) -> float:
    """Return the distance of the nearest side of a convex polygon (n, 2) from the origin."""
    return float(-scipy.spatial.ConvexHull(outline).equations[:, -1].max())


def _as_mesh(points: Floats) -> Mesh:
    return tuple(chain.from_iterable(points.tolist()))


def _spell(point: Floats) -> str:
    return f"({', '.join(f'{part:.6g}' for part in point)})"


def _refused(path: Path, allowed: str) -> InvalidSettingError:
    return InvalidSettingError("--mesh", str(path), allowed)
