"""The can and its point mass as one body, against sums over masses told anew."""

from dataclasses import replace

import numpy as np
import pytest

from models import Effects, PointMass, Scene, load
from models.mass import body

EPS = np.finfo(np.float64).eps
POINTS = [
    PointMass(mass=0.004, x=0.02, y=0.005, z=-0.01),
    PointMass(mass=0.1, z=0.05),
    PointMass(mass=1e-6, y=-0.03),
]


def weighted(point: PointMass) -> Scene:
    return replace(load("gentle-rock"), effects=Effects(point_mass=point))


def inertia_about(masses: np.ndarray, places: np.ndarray, about: np.ndarray) -> np.ndarray:
    """Return the sum of m (r.r 1 - r r^T), kg m^2."""
    r = places - about
    each = (m * (x @ x * np.eye(3) - np.outer(x, x)) for m, x in zip(masses, r, strict=True))
    return np.asarray(sum(each))


@pytest.mark.parametrize("point", POINTS)
def test_it_is_the_sum_of_its_masses(point: PointMass) -> None:
    scene = weighted(point)
    can, whole = scene.can, body(scene)
    # six points on the axes that have the can's mass and moments: m r^2/3 on each axis
    A, C, m = can.transverse_inertia, can.axial_inertia, can.mass
    squares = 3.0 * np.array((C / 2.0, C / 2.0, A - C / 2.0)) / m
    arms = np.diag(np.sqrt(squares))
    places = np.vstack((arms, -arms, (point.x, point.y, point.z)))
    masses = np.array((*(m / 6.0,) * 6, point.mass))
    centre = masses @ places / masses.sum()
    assert whole.mass == pytest.approx(masses.sum(), rel=4 * EPS, abs=0)
    np.testing.assert_allclose(whole.centre, centre, atol=8 * EPS * 0.05, rtol=0)
    expected = inertia_about(masses, places, centre)
    np.testing.assert_allclose(whole.inertia, expected, atol=16 * EPS * expected.max(), rtol=0)


@pytest.mark.parametrize("point", POINTS)
def test_its_principal_axes_are_a_rotation_near_the_cans_own(point: PointMass) -> None:
    whole = body(weighted(point))
    moments, axes = whole.principal()
    assert np.linalg.det(axes) == pytest.approx(1.0, abs=16 * EPS)
    assert (np.diagonal(axes) > 0.5).all()
    found = axes @ np.diag(moments) @ axes.T
    np.testing.assert_allclose(found, whole.inertia, atol=32 * EPS * moments.max(), rtol=0)


def test_a_can_alone_is_itself_to_the_bit() -> None:
    scene = load("gentle-rock")
    whole = body(scene)
    moments, axes = whole.principal()
    A, C = scene.can.transverse_inertia, scene.can.axial_inertia
    assert whole.mass == scene.can.mass
    np.testing.assert_array_equal(whole.centre, 0.0)
    np.testing.assert_array_equal(moments, (A, A, C))
    np.testing.assert_array_equal(axes, np.eye(3))
