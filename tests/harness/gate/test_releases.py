"""Which releases there are, and how one is installed: by what is there, or not at all."""

import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from harness.core.environments import VARIABLE
from harness.core.errors import InvalidSettingError
from harness.engines import make_environment, registry
from harness.engines.make_environment import Interpreter, released_versions
from harness.gate.history.releases import Installation, PackageRelease, install, parse_versions
from tests.support.environments import described

pytestmark = pytest.mark.engine("mujoco")


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "engines"))
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    registry.forget_engines()
    yield
    registry.forget_engines()


def test_an_environment_with_the_release_is_taken_as_it_is() -> None:
    version = registry.engine("mujoco").version
    release = PackageRelease(engine="mujoco", version=version, released=("9.9",))
    entry = registry.entry_of("mujoco").value
    described("built", entry, sys.executable, command="engines add mujoco --wheel x.whl")
    assert install(release).reason == "the package index has no wheel of it for this Python"
    described("mine", entry, sys.executable, command="engines add mujoco --name mine")
    assert install(release) == Installation(name="mine")


def test_a_release_without_a_wheel_is_not_built_from_its_sources(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(make_environment, "_run", None)
    one = install(PackageRelease(engine="mujoco", version="1.0", released=("9.9",)))
    assert one == Installation(reason="the package index has no wheel of it for this Python")


def test_an_environment_that_is_broken_is_a_reason() -> None:
    version = registry.engine("mujoco").version
    described("broken", "nothing_of_the_kind:Engine", sys.executable, command="add")
    one = install(PackageRelease(engine="mujoco", version=version))
    assert one.name == ""
    assert "nothing_of_the_kind" in one.reason


@pytest.mark.parametrize(
    ("said", "code", "versions"),
    [
        ("mujoco (3.10.0)\nAvailable versions: 3.10.0, 3.9.0, 3.2.7\n", 0, "3.2.7 3.9.0 3.10.0"),
        ("ERROR: No matching distribution found\n", 1, ""),
        ("something else\n", 0, ""),
    ],
)
def test_pip_is_asked_for_wheels_of_an_interpreter(
    monkeypatch: pytest.MonkeyPatch, said: str, code: int, versions: str
) -> None:
    asked: list[Sequence[str]] = []

    def run(words: Sequence[str]) -> "subprocess.CompletedProcess[str]":
        asked.append(words)
        return subprocess.CompletedProcess(words, code, said, "")

    monkeypatch.setattr(make_environment, "_run", run)
    entry, base = registry.entry_of("mujoco"), Interpreter("/usr/bin/python3.11", "3.11.7", ())
    assert released_versions(entry, base) == tuple(versions.split())
    words = " ".join(asked[-1])
    assert "--python /usr/bin/python3.11 index versions --only-binary :all:" in words
    assert words.endswith(" mujoco")


def test_versions_are_sorted_each_once_and_spelt_as_they_are_released() -> None:
    released = ("3.5.0", "3.10.0")
    assert parse_versions("3.10, 3.5.0,3.5", released) == ("3.5.0", "3.10.0")
    assert parse_versions("4.1,3.5", released) == ("3.5.0", "4.1")
    assert parse_versions("all", released) == released


@pytest.mark.parametrize("text", ["", "3.5.0", "3.5,3.5.0", "new,old", "all"])
def test_less_than_two_versions_are_refused(text: str) -> None:
    with pytest.raises(InvalidSettingError, match=r"two released versions or more"):
        parse_versions(text, ())
