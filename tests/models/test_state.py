"""Releases, poses and twists, and the effects: what they keep and what they refuse."""

import math
import pickle
from typing import Any

import numpy as np
import pytest

from models import IDEAL, Effects, InvalidValueError, Pose, Release, Slip, Twist


def test_what_a_release_leaves_out_is_zero() -> None:
    release = Release(phi=0.4)
    assert (release.psi, release.theta) == (0.0, 0.0)
    assert (release.phi_dot, release.psi_dot, release.theta_dot) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("phi", [0.0, -0.1, math.pi / 2, 2.0])
def test_a_release_stands_on_one_point_of_its_rim(phi: float) -> None:
    with pytest.raises(InvalidValueError) as caught:
        Release(phi=phi)
    assert (caught.value.key, caught.value.value) == ("phi", phi)


@pytest.mark.parametrize("key", ["phi", "psi", "theta", "phi_dot", "psi_dot", "theta_dot"])
@pytest.mark.parametrize("value", [math.nan, -math.inf, "fast", 1j, 10**400])
def test_a_release_is_finite(key: str, value: Any) -> None:
    fields: dict[str, Any] = {"phi": 0.4} | {key: value}
    with pytest.raises(InvalidValueError) as caught:
        Release(**fields)
    assert (caught.value.key, caught.value.allowed) == (key, "a finite number")


def test_equal_numbers_make_equal_releases_whatever_their_type() -> None:
    half: Any = np.float32(0.5)
    left = Release(phi=half, psi=-0.0, theta_dot=2)
    right = Release(phi=0.5, psi=0.0, theta_dot=2.0)
    assert left == right
    assert hash(left) == hash(right)
    assert repr(left) == repr(right)


def test_poses_and_twists_keep_read_only_copies() -> None:
    position = np.zeros(3)
    quaternion: Any = (1, 0, 0, 0)
    pose = Pose(position=position, quaternion=quaternion)
    position[0] = 1.0
    assert pose.position[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        pose.quaternion[0] = 2.0
    rows: dict[str, Any] = {"velocity": (1, 2, 3), "angular_velocity": (4, 5, 6)}
    twist = Twist(**rows)
    assert twist.velocity.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        twist.angular_velocity[0] = 0.0


@pytest.mark.parametrize(
    ("position", "quaternion", "key", "value", "allowed"),
    [
        ((0.0, 0.0), (1, 0, 0, 0), "position", "[0.0, 0.0]", "3 finite numbers"),
        ((0, 0, math.nan), (1, 0, 0, 0), "position", "[0.0, 0.0, nan]", "3 finite numbers"),
        ((0, 0, 0), (1, 0, 0), "quaternion", "[1.0, 0.0, 0.0]", "4 finite numbers"),
        ((0, 0, 0), (2, 0, 0, 0), "quaternion", "[2.0, 0.0, 0.0, 0.0]", "of unit length"),
    ],
)
def test_a_pose_is_a_point_and_a_rotation(
    position: Any, quaternion: Any, key: str, value: str, allowed: str
) -> None:
    with pytest.raises(InvalidValueError) as caught:
        Pose(position=position, quaternion=quaternion)
    error = caught.value
    assert (error.key, str(error.value), error.allowed) == (key, value, allowed)


def test_the_ideal_can_declares_no_effect() -> None:
    assert Effects().declared() == ()
    assert Effects() == IDEAL
    assert Effects(slip=Slip(mu=0.0)).declared() == ("slip",)  # frictionless is an effect


@pytest.mark.parametrize("mu", [-0.1, math.nan, math.inf, "smooth"])
def test_friction_is_finite_and_never_drives(mu: Any) -> None:
    with pytest.raises(InvalidValueError) as caught:
        Slip(mu=mu)
    assert (caught.value.key, repr(caught.value.value)) == ("mu", repr(mu))


def test_an_effect_is_an_object_and_not_its_constant() -> None:
    with pytest.raises(InvalidValueError) as caught:
        Effects(slip=0.3)  # type: ignore[arg-type]
    error = caught.value
    assert (error.key, error.value, error.allowed) == ("slip", 0.3, "a Slip or None")


def test_values_survive_pickling() -> None:
    for value in (Release(phi=0.4, psi_dot=2.0), Effects(slip=Slip(mu=0.3))):
        assert pickle.loads(pickle.dumps(value)) == value  # noqa: S301  # our own bytes
