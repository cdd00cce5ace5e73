"""A release above the plane or inside it, and the scenes that have one."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models import (
    InvalidValueError,
    Release,
    Scene,
    contact_point,
    load,
    read_scene,
    release_state,
    write_scene,
)

EPS = np.finfo(np.float64).eps


def at(height: float) -> Scene:
    scene = load("gentle-rock")
    return replace(scene, release=replace(scene.release, height=height))


@pytest.mark.parametrize("height", [0.01, -0.001])
def test_the_lowest_point_is_at_the_height_and_at_rest(height: float) -> None:
    scene = at(height)
    pose, twist = release_state(scene.can, scene.release)
    low = contact_point(scene.can, pose.position, pose.quaternion)[2]
    assert low == pytest.approx(height, abs=8 * EPS * scene.can.bounding_radius)
    _, on_the_rim = release_state(scene.can, load("gentle-rock").release)
    assert np.array_equal(twist.velocity, on_the_rim.velocity)


def test_a_scene_on_its_rim_says_nothing_of_a_height_so_that_its_digest_stays() -> None:
    assert "height" not in at(0.0).to_dict()["release"]
    assert at(0.0) == load("gentle-rock")
    assert at(0.01).to_dict()["release"]["height"] == 0.01


def test_a_height_is_written_and_read_back(tmp_path: Path) -> None:
    scene = at(-0.001)
    file = tmp_path / "scene.toml"
    file.write_text(write_scene(scene), encoding="utf-8")
    assert read_scene(file) == scene


def test_a_height_is_finite() -> None:
    with pytest.raises(InvalidValueError) as caught:
        Release(phi=0.4, height=float("inf"))
    assert (caught.value.key, caught.value.value) == ("height", float("inf"))
