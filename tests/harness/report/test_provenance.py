"""Where a result comes from, told without ever failing."""

import json
import shutil
import subprocess
from datetime import UTC, datetime, timedelta
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

from harness.core.provenance import commit_of, provenance
from reference.numerics.compiled import path_taken

needs_git = pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")


def git(folder: Path, *words: str) -> str:
    who = ["-c", "user.name=a", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false"]
    return subprocess.run(  # noqa: S603 # words of this test
        [str(shutil.which("git")), *who, *words],
        cwd=folder,
        check=True,
        capture_output=True,
        text=True,
    ).stdout.strip()


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    git(tmp_path, "init", "-q")
    (tmp_path / "tracked.py").write_text("one")
    git(tmp_path, "add", "tracked.py")
    git(tmp_path, "commit", "-q", "-m", "one")
    return tmp_path


def test_what_it_tells_goes_into_a_manifest() -> None:
    told = provenance().to_dict()
    assert json.loads(json.dumps(told)) == told
    assert told["packages"]["numpy"] == np.__version__
    assert told["cores"] >= 1
    assert told["processor"]
    written = datetime.fromisoformat(told["written"])
    # a test that takes a minute here hangs
    assert timedelta(0) <= datetime.now(UTC) - written < timedelta(minutes=1)


def test_which_code_solved_releases_is_told() -> None:
    assert provenance().to_dict()["reference"] == "numpy"
    told = provenance(reference=path_taken(compiled=True)).to_dict()
    assert told["reference"] == f"compiled, numba {version('numba')}"


@needs_git
def test_the_commit_of_a_tracked_file(checkout: Path) -> None:
    commit = commit_of(checkout / "tracked.py")
    assert commit is not None
    assert commit.digest == git(checkout, "rev-parse", "HEAD")
    assert not commit.changed


@needs_git
def test_a_change_is_told_but_a_new_file_is_none(checkout: Path) -> None:
    (checkout / "new.py").touch()
    commit = commit_of(checkout / "tracked.py")
    assert commit is not None
    assert not commit.changed
    (checkout / "tracked.py").write_text("two")
    commit = commit_of(checkout / "tracked.py")
    assert commit is not None
    assert commit.changed


@needs_git
def test_a_package_installed_below_another_checkout_has_no_commit(checkout: Path) -> None:
    installed = checkout / ".venv" / "site-packages"
    installed.mkdir(parents=True)
    (installed / "package.py").touch()
    assert commit_of(installed / "package.py") is None


@needs_git
def test_another_checkout_in_the_environment_does_not_speak(
    checkout: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    alone = tmp_path_factory.mktemp("alone")
    (alone / "tracked.py").touch()
    monkeypatch.setenv("GIT_DIR", str(checkout / ".git"))
    monkeypatch.setenv("GIT_WORK_TREE", str(checkout))
    assert commit_of(alone / "tracked.py") is None


def test_without_git_there_is_no_commit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert commit_of(Path(__file__)) is None
