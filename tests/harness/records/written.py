"""Exact motions as programs of other conventions would write them, by matrices."""

import itertools
import math
from pathlib import Path

import numpy as np
import pandas as pd

from harness.records.convention import CHOICES, Convention
from harness.records.export import exact_frame
from models import Scene

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def basis(axis: str, hand: str) -> np.ndarray:
    """Return the axes of a program as columns in ours: one of them is our z, in a hand."""
    up = np.array(AXES[axis.removeprefix("-")]) * (-1.0 if axis.startswith("-") else 1.0)
    for first, second in itertools.product(np.eye(3), repeat=2):
        theirs = np.array((first, second, up))  # rows: our x, y, z in theirs
        proper = np.linalg.det(theirs)
        if abs(abs(proper) - 1.0) < 1e-9 and (proper > 0.0) == (hand == "right"):
            return theirs
    raise AssertionError(axis)


def matrices(q: np.ndarray) -> np.ndarray:
    """Return rotation matrices of quaternions, scalar first, shape (n, 3, 3)."""
    w, x, y, z = q.T
    return np.moveaxis(
        np.array(
            (
                (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
                (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
                (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
            )
        ),
        -1,
        0,
    )


def quaternions(R: np.ndarray) -> np.ndarray:
    """Return quaternions, scalar first, of rotation matrices, by the largest component."""
    q = np.empty((len(R), 4))
    for n, m in enumerate(R):
        trace = np.array((m.trace(), *np.diag(m)))
        k = int(np.argmax(trace))
        if k == 0:
            w = math.sqrt(max(1.0 + trace[0], 0.0)) / 2.0
            q[n] = (
                w,
                *(np.array((m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1])) / (4 * w)),
            )
            continue
        i, j, o = k - 1, k % 3, (k + 1) % 3
        u = math.sqrt(max(1.0 + m[i, i] - m[j, j] - m[o, o], 0.0)) / 2.0
        q[n, 0] = (m[o, j] - m[j, o]) / (4 * u)
        q[n, 1 + i], q[n, 1 + j], q[n, 1 + o] = (
            u,
            (m[j, i] + m[i, j]) / (4 * u),
            (m[o, i] + m[i, o]) / (4 * u),
        )
    return q


def frame_of(scene: Scene, convention: Convention) -> pd.DataFrame:
    """Return the exact motion of a scene as a program of a convention writes it."""
    own = exact_frame(scene)
    S = basis(convention.up, convention.hand).T  # theirs from ours: columns are our axes in theirs
    T = basis(convention.axis, convention.hand).T
    R = matrices(own[["qw", "qx", "qy", "qz"]].to_numpy())
    hand = np.linalg.det(S)
    theirs = S @ R @ T.T
    if convention.quaternion == "world-to-body":
        theirs = np.moveaxis(theirs, 1, 2)
    q = quaternions(theirs)
    if convention.order == "xyzw":
        q = np.roll(q, -1, axis=1)
    position = own[["x_m", "y_m", "z_m"]].to_numpy()
    velocity = own[["vx_m_s", "vy_m_s", "vz_m_s"]].to_numpy()
    spin = own[["wx_rad_s", "wy_rad_s", "wz_rad_s"]].to_numpy()
    force = own[["force_x_n", "force_y_n", "force_z_n"]].to_numpy()
    if convention.origin == "base":
        arm = R @ np.array((0.0, 0.0, -scene.can.half_height))
        position, velocity = position + arm, velocity + np.cross(spin, arm)
    if convention.spin == "body":
        spin = np.einsum("nij,nj->ni", np.moveaxis(R, 1, 2), spin) @ T.T
    else:
        spin = spin @ S.T
    written = own.copy()
    written[["qw", "qx", "qy", "qz"]] = q
    written[["x_m", "y_m", "z_m"]] = position @ S.T
    written[["vx_m_s", "vy_m_s", "vz_m_s"]] = velocity @ S.T
    written[["wx_rad_s", "wy_rad_s", "wz_rad_s"]] = hand * spin
    written[["force_x_n", "force_y_n", "force_z_n"]] = force @ S.T
    if convention.up != "z":
        written = written.drop(columns=["contact_x_m", "contact_y_m"])
    return written


def saved(frame: pd.DataFrame, path: Path) -> Path:
    """Return the path at which a record was written."""
    frame.to_csv(path, index=False)
    return path


EVERY = [
    Convention(**dict(zip(CHOICES, words, strict=True)))
    for words in itertools.product(*CHOICES.values())
]
