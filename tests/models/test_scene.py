"""Scenes are values: hashable, picklable, equal when they say the same."""

import json
import pickle
from dataclasses import FrozenInstanceError, replace
from typing import Any

import pytest

from models import Can, Effects, Horizon, InvalidValueError, Release, Scene, Slip, load

SCENE = Scene(
    name="a-scene",
    cite="here",
    gravity=9.81,
    can=Can.from_groups(mass=0.043, radius=0.037, a=0.727, c=0.615, h=1.473),
    release=Release(phi=0.4, psi_dot=2.0),
    horizon=Horizon(bounces=3),
)


def test_scenes_are_values() -> None:
    again = pickle.loads(pickle.dumps(SCENE))  # noqa: S301  # our own bytes
    assert again == SCENE
    assert hash(again) == hash(SCENE)
    assert len({SCENE, again, replace(SCENE, gravity=9.8)}) == 2
    with pytest.raises(FrozenInstanceError):
        SCENE.gravity = 1.0  # type: ignore[misc]


def test_the_dictionary_tells_equal_from_different_scenes() -> None:
    integers = replace(SCENE, gravity=9, release=Release(phi=0.4, psi_dot=2, theta=-0.0))
    doubles = replace(SCENE, gravity=9.0, release=Release(phi=0.4, psi_dot=2.0))
    assert json.dumps(integers.to_dict()) == json.dumps(doubles.to_dict())
    slipping = replace(SCENE, effects=Effects(slip=Slip(mu=0.3)))
    assert slipping.to_dict()["effects"] == {"slip": {"mu": 0.3}}
    assert slipping.to_dict() != SCENE.to_dict()
    assert replace(SCENE, horizon=Horizon(seconds=2)).to_dict()["horizon"] == {"seconds": 2.0}


def test_scenes_differ_in_every_thing_they_say() -> None:
    others = (load("petals"), load("wobble"), load("cusps"), load("steady-rolling"), SCENE)
    assert len({json.dumps(scene.to_dict()) for scene in others}) == len(others)


@pytest.mark.parametrize(
    "name", ["", "-dash-first", "Upper", "with space", "a/b", "../up", "a" * 65, "a\n", 3, "<x>"]
)
def test_a_name_is_safe_as_a_file_name(name: Any) -> None:
    with pytest.raises(InvalidValueError) as caught:
        replace(SCENE, name=name)
    assert (caught.value.key, caught.value.value) == ("name", name)


@pytest.mark.parametrize("cite", ["two\nlines", "x" * 501, "\x00", "\ud800", None])
def test_a_citation_is_one_printable_line(cite: Any) -> None:
    with pytest.raises(InvalidValueError) as caught:
        replace(SCENE, cite=cite)
    assert (caught.value.key, caught.value.value) == ("cite", cite)
    assert caught.value.allowed == "at most 500 printable characters on one line"


@pytest.mark.parametrize("gravity", [-9.81, float("nan"), float("inf"), "heavy"])
def test_gravity_points_down(gravity: Any) -> None:
    with pytest.raises(InvalidValueError) as caught:
        replace(SCENE, gravity=gravity)
    assert (caught.value.key, repr(caught.value.value)) == ("gravity", repr(gravity))


def test_free_fall_is_a_scene() -> None:
    assert replace(SCENE, gravity=0.0).gravity == 0.0


@pytest.mark.parametrize("key", ["can", "release", "effects", "horizon"])
def test_parts_are_of_their_kind(key: str) -> None:
    part: dict[str, Any] = {key: None}
    with pytest.raises(InvalidValueError) as caught:
        replace(SCENE, **part)
    error = caught.value
    assert (error.key, error.value, error.allowed) == (key, None, f"a {key.title()}")


@pytest.mark.parametrize(
    ("bounces", "seconds", "given"), [(None, None, "neither"), (1, 1.0, "both")]
)
def test_a_horizon_is_one_or_the_other(
    bounces: int | None, seconds: float | None, given: str
) -> None:
    with pytest.raises(InvalidValueError) as caught:
        Horizon(bounces=bounces, seconds=seconds)
    assert (caught.value.key, caught.value.value) == ("horizon", given)


@pytest.mark.parametrize("bounces", [0, -1, 100_001, 1.0, True, "one"])
def test_bounces_are_counted(bounces: Any) -> None:
    with pytest.raises(InvalidValueError) as caught:
        Horizon(bounces=bounces)
    assert caught.value.key == "bounces"
    assert caught.value.value is bounces


@pytest.mark.parametrize("seconds", [0.0, -1.0, float("inf"), True])
def test_seconds_pass(seconds: Any) -> None:
    with pytest.raises(InvalidValueError) as caught:
        Horizon(seconds=seconds)
    assert (caught.value.key, caught.value.value) == ("seconds", seconds)
