"""Scene files that cannot be read as text, and text that is written to be read again."""

import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models import (
    Can,
    Effects,
    Horizon,
    Release,
    Scene,
    SceneFileError,
    Slip,
    load,
    read_scene,
    write_scene,
)

GOOD = write_scene(load("gentle-rock"))


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "scene.toml"


def problem(path: Path) -> str:
    """Return the one thing that is wrong with the file, without its name."""
    with pytest.raises(SceneFileError) as caught:
        read_scene(path)
    assert str(caught.value).startswith(f"scene file '{path}': ")
    assert caught.value.keys == ("",)
    (only,) = caught.value.problems
    return only


def test_what_is_no_file_is_said_to_be_none(tmp_path: Path) -> None:
    assert problem(tmp_path / "nowhere.toml") == "there is no such file"
    assert problem(tmp_path) == "is not a regular file"
    assert problem(Path(os.devnull)) == "is not a regular file"
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)  # opening it would wait for ever
    assert problem(pipe) == "is not a regular file"
    assert problem(tmp_path / ("x" * 5000)) == "cannot be read: File name too long"


def test_a_file_that_may_not_be_read_says_so(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path.write_text(GOOD)

    def refuse(*_: object) -> None:  # permissions do not stop the superuser, so neither can a mode
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    assert problem(path) == "cannot be read: Permission denied"


def test_bytes_that_are_not_text_are_refused(path: Path) -> None:
    path.write_bytes(b'name = "\xff"')
    assert problem(path) == "is not UTF-8 text (byte 8)"


def test_a_huge_file_is_refused_unread(path: Path) -> None:
    path.write_text(GOOD + "#" * 1_000_000)
    assert problem(path) == "is larger than 1000000 bytes, which no scene needs"
    path.write_text(GOOD + "#" * (1_000_000 - len(GOOD)))
    assert read_scene(path).name == "gentle-rock"


numbers = st.floats(allow_nan=False, allow_infinity=False)
scenes = st.builds(
    Scene,
    name=st.from_regex(r"[a-z0-9][a-z0-9._-]{0,63}", fullmatch=True),
    cite=st.text(max_size=60).filter(str.isprintable),
    gravity=st.floats(0.0, 1e6),
    can=st.builds(
        Can,
        mass=st.floats(1e-9, 1e9),
        radius=st.floats(1e-9, 1e9),
        half_height=st.floats(1e-9, 1e9),
        transverse_inertia=st.floats(1.0, 1e9),
        axial_inertia=st.floats(1e-9, 2.0),
    ),
    release=st.builds(
        Release,
        phi=st.floats(1e-300, 1.5),
        psi=numbers,
        theta=numbers,
        phi_dot=numbers,
        psi_dot=numbers,
        theta_dot=numbers,
    ),
    effects=st.builds(Effects, slip=st.none() | st.builds(Slip, mu=st.floats(0.0, 1e300))),
    horizon=st.builds(Horizon, bounces=st.integers(1, 100_000))
    | st.builds(Horizon, seconds=st.floats(1e-300, 1e300)),
)


@given(scene=scenes)
def test_what_is_written_reads_back_equal_to_the_last_bit(
    scene: Scene, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.mktemp("scenes") / "scene.toml"
    path.write_text(write_scene(scene), encoding="utf-8")
    assert read_scene(path) == scene
