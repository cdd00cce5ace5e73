"""The folder of environments: what is removed from it, what it has to be, and what is made once."""

import json
import os
import platform
import subprocess
import sys
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from harness.core.environments import VARIABLE, environment
from harness.engines import new_environment, registry
from tests.support.command_line import Command
from tests.support.environments import bare_environment, described

pytestmark = pytest.mark.engine("mujoco")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Return a folder of environments that is not there yet."""
    monkeypatch.setenv(VARIABLE, str(tmp_path / "engines"))
    monkeypatch.setenv("PIP_NO_INDEX", "1")  # nothing is fetched
    registry.forget_engines()
    yield tmp_path / "engines"
    registry.forget_engines()


def test_what_a_killed_program_leaves_is_removed_by_the_next_and_nothing_else(
    rockingcan: Command, folder: Path
) -> None:
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    here, day = platform.node(), 86400.0

    def leave(name: str, process: int, host: str = here, age: float = 0.0) -> None:
        (folder / name).mkdir(parents=True)
        (folder / name / "pyvenv.cfg").touch()
        maker = folder / name / "rockingcan.json"
        maker.write_text(json.dumps({"host": host, "process": process}))
        os.utime(maker, (time.time() - age,) * 2)

    gone = f"mujoco-{ended.pid}"
    leave(f"{gone}-01234567", ended.pid)
    leave(f"{gone}-11111111", ended.pid, "another", 1.1 * day)
    kept = [f"mujoco-{os.getpid()}-01234567", f"{gone}-22222222", f"{gone}-33333333"]
    leave(kept[0], os.getpid())
    leave(kept[1], ended.pid, "another", 0.9 * day)
    leave(kept[2], os.getpid())  # which has been renamed
    kept += [f"{gone}-old", "myproject-310-old", f"{gone}-44444444", f"{gone}-55555555"]
    leave(kept[3], ended.pid)
    for name in kept[4:6]:
        bare_environment(folder / name, [])
    leave(kept[6], ended.pid)
    described("listed", "a:B", str(folder.with_name("link") / kept[6] / "bin" / "python"))
    refused = rockingcan("engines", "add", "mujoco", "--interpreter", "/bin/false")
    assert refused.code == 2
    assert len(list(folder.iterdir())) == len(kept) + 3
    assert rockingcan("engines", "add", "mujoco", "--interpreter", sys.executable).code == 0
    left = {path.name for path in folder.iterdir() if path.is_dir()}
    assert left == set(kept)


@pytest.mark.parametrize("place", ["file", "file/below"])
def test_a_folder_of_environments_that_is_none_is_one_sentence(
    rockingcan: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv(VARIABLE, str(tmp_path / place))
    registry.forget_engines()
    refused = rockingcan("engines", "add", "mujoco", "--interpreter", sys.executable)
    assert refused.code == 2
    assert refused.err == (
        f"rockingcan: cannot write an environment to '{tmp_path / place}': Not a directory; name a "
        f"folder in which files can be made and linked with {VARIABLE}\n"
    )
    assert environment("mine") is None


@pytest.mark.parametrize("refusing", ["hardlink_to", "mkdir"])
def test_a_folder_that_takes_no_file_or_link_is_told_before_the_work(
    rockingcan: Command, monkeypatch: pytest.MonkeyPatch, folder: Path, refusing: str
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(new_environment, "make_environment", None)  # which is not come to
    with monkeypatch.context() as patch:
        patch.setattr(Path, refusing, refuse)
        refused = rockingcan("engines", "add", "mujoco", "--name", "mine")
    assert refused.code == 2
    assert refused.err.startswith(f"rockingcan: cannot write an environment to '{folder}': Oper")
    assert len(refused.err.splitlines()) == 1
    assert not folder.exists() or list(folder.iterdir()) == []


def test_the_version_to_install_is_known_before_the_environment_is_made(
    rockingcan: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    info = "mujoco-9.7.dist-info"
    with zipfile.ZipFile(tmp_path / "mujoco-9.7-py3-none-any.whl", "w") as wheel:
        wheel.writestr("mujoco/__init__.py", "")
        wheel.writestr(f"{info}/METADATA", "Metadata-Version: 2.1\nName: mujoco\nVersion: 9.7\n")
        tag = "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
        wheel.writestr(f"{info}/WHEEL", tag)
        wheel.writestr(f"{info}/RECORD", "")
    monkeypatch.setenv("PIP_FIND_LINKS", str(tmp_path))
    monkeypatch.setattr(new_environment, "make_environment", None)  # which is not come to
    entry = registry.entry_of("mujoco").value
    described("mujoco-9.7", entry, sys.executable, command="another")
    taken = rockingcan("engines", "add", "mujoco")
    assert taken.code == 2
    assert "the name 'mujoco-9.7' is taken" in taken.err
    described("mujoco-9.7", entry, sys.executable, command="rockingcan engines add mujoco")
    kept = rockingcan("engines", "add", "mujoco")
    assert (kept.code, kept.err) == (0, "")
    assert kept.out.startswith("kept 'mujoco-9.7': python")
    # a wheel may be another of the same name
    wheel_of = str(tmp_path / "mujoco-9.7-py3-none-any.whl")
    again = rockingcan("engines", "add", "mujoco", "--wheel", wheel_of)
    assert "the name 'mujoco-9.7' is taken" in again.err
