"""Records of every convention are understood, or refused in a sentence; none is assumed."""

import math
import random
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from harness.metrics.error import rotation_between
from harness.records.columns import RecordFileError, mapping, read_columns
from harness.records.convention import Convention
from harness.records.export import exact_frame
from harness.records.understanding import Understood, understand
from models import Scene, load
from models.kinematics import angles
from tests.harness.records.written import EVERY, frame_of, saved

CHOSEN = random.Random(20).sample(EVERY, 24)  # noqa: S311 - a choice, no secret
"""Of two thousand."""

Reader = Callable[..., Understood]


@pytest.fixture
def understood(tmp_path: Path) -> Reader:
    """Return a function that writes a frame and reads it as a motion of a scene."""

    def read(frame: pd.DataFrame, scene: Scene, *pairs: str, **given: str) -> Understood:
        path = saved(frame, tmp_path / "motion.csv")
        return understand(read_columns(path, mapping(pairs)), scene, given)

    return read


def off(found: Understood, scene: Scene) -> tuple[float, ...]:
    """Return how far a motion is from the exact one: angle, place, velocity, spin, force."""
    own, exact = found.trajectory, exact_frame(scene)

    def apart(values: np.ndarray, names: str) -> float:
        return float(np.abs(values - exact[names.split()].to_numpy()).max())

    return (
        float(rotation_between(own.quaternion, exact[["qw", "qx", "qy", "qz"]].to_numpy()).max()),
        apart(own.position, "x_m y_m z_m"),
        apart(own.velocity, "vx_m_s vy_m_s vz_m_s"),
        apart(own.angular_velocity, "wx_rad_s wy_rad_s wz_rad_s"),
        apart(own.contact_force, "force_x_n force_y_n force_z_n"),
    )


@pytest.mark.parametrize("convention", CHOSEN, ids=Convention.sentence)
def test_a_convention_is_found_by_itself(
    gentle: Scene, understood: Reader, convention: Convention
) -> None:
    found = understood(frame_of(gentle, convention), gentle)
    angle, place, velocity, spin, force = off(found, gentle)
    assert max(angle, place, velocity, spin, force) < 1e-11
    assert found.convention.spin == convention.spin
    assert found.convention.origin == convention.origin


@pytest.mark.parametrize("convention", CHOSEN[:6], ids=Convention.sentence)
def test_the_bounce_tells_where_the_fall_is_alike(
    understood: Reader, convention: Convention
) -> None:
    scene = load("paper-release")  # falls in a plane, in which a mirror changes nothing
    found = understood(frame_of(scene, convention), scene)
    angle, place, *_ = off(found, scene)
    assert max(angle, place) < 1e-9


def test_our_own_columns_are_taken_as_they_are(gentle: Scene, understood: Reader) -> None:
    found = understood(exact_frame(gentle), gentle)
    assert off(found, gentle) == (0.0,) * 5
    assert found.convention == Convention()
    assert found.unknown == ()


def test_other_units_and_names_are_mapped(gentle: Scene, understood: Reader) -> None:
    frame = exact_frame(gentle)
    frame["Time"] = 1e3 * frame.pop("time_s")
    for axis in "xyz":
        frame[f"pos.{axis}"] = 1e3 * frame.pop(f"{axis}_m")
        frame[f"w{axis}_deg_s"] = np.rad2deg(frame.pop(f"w{axis}_rad_s"))
    pairs = ("time_ms=Time", *(f"{axis}_mm=pos.{axis}" for axis in "xyz"))
    found = understood(frame, gentle, *pairs)
    assert max(off(found, gentle)) < 1e-12
    assert "pos.x in mm" in found.said[0]


def test_angles_stand_for_a_quaternion(gentle: Scene, understood: Reader) -> None:
    frame = exact_frame(gentle)
    q = frame[["qw", "qx", "qy", "qz"]].to_numpy()
    frame = frame.drop(columns=["qw", "qx", "qy", "qz"])
    for name, values in zip(("phi", "psi", "theta"), angles(q), strict=True):
        frame[f"{name}_deg"] = np.rad2deg(values)
    assert max(off(understood(frame, gentle), gentle)) < 1e-12


def test_what_is_not_there_is_derived_or_told_to_be_unknown(
    gentle: Scene, understood: Reader
) -> None:
    frame = exact_frame(gentle)
    frame = frame[[name for name in frame.columns if name[0] not in "vwcfd"]]
    found = understood(frame, gentle)
    angle, place, velocity, spin, force = off(found, gentle)
    assert angle == place == 0.0
    assert math.isnan(force)
    assert velocity < 2e-4  # of 0.08 m/s
    assert spin < 0.5  # of 144 rad/s
    assert "forces" in " ".join(found.unknown)
    assert "by splines" in " ".join(found.said)
    assert (found.trajectory.contact_count == 1).all()  # told by the depth


def test_another_heading_place_and_start_of_the_clock_are_told(
    gentle: Scene, understood: Reader
) -> None:
    frame = exact_frame(gentle)
    frame["time_s"] += 12.5
    frame["x_m"] += 3.0
    found = understood(frame, gentle)
    angle, place, *_ = off(found, gentle)
    assert angle == 0.0
    assert place < 1e-14
    assert any("moved by -3 m" in sentence for sentence in found.said)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"z_m": 2.0}, "starts at a height of"),
        ({"qw": 0.5}, "has length"),
        ({"wx_rad_s": 30.0}, "starts with an angular velocity"),
    ],
)
def test_what_is_not_the_scenes_motion_is_refused(
    gentle: Scene, understood: Reader, change: dict[str, float], why: str
) -> None:
    frame = exact_frame(gentle)
    for name, factor in change.items():
        frame[name] *= factor
    with pytest.raises(RecordFileError, match=why):
        understood(frame, gentle)


def test_a_motion_of_another_scene_is_refused(gentle: Scene, understood: Reader) -> None:
    with pytest.raises(RecordFileError, match="is no motion of scene 'paper-release'"):
        understood(exact_frame(gentle), load("paper-release"))


def test_what_is_given_is_not_sought(gentle: Scene, understood: Reader) -> None:
    frame = frame_of(gentle, Convention(up="y"))
    with pytest.raises(RecordFileError, match="by any convention that is left"):
        understood(frame, gentle, up="z")
    assert understood(frame, gentle, up="y").convention.up == "y"
