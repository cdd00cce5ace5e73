"""The program before its packages are imported: where it runs, and what may shadow it."""

import os
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
VERSION = f"rockingcan {version('rockingcan')}\n"


def started(folder: Path, *words: str, path: str = str(ROOT)) -> tuple[int, str, str]:
    """Return code, answer and message of a Python that is started in a folder."""
    done = subprocess.run(  # noqa: S603 - our own words
        [sys.executable, *words],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize("platform", ["darwin", "win32", "freebsd14"])
def test_on_another_system_it_says_so_and_imports_nothing(platform: str, tmp_path: Path) -> None:
    program = (
        f"import sys; sys.platform = {platform!r}; import rockingcan, atexit\n"
        "atexit.register(lambda: print([n for n in sys.modules if n.startswith('harness')]))\n"
        "rockingcan.main()"
    )
    code, said, message = started(tmp_path, "-c", program)
    assert (code, said) == (2, "[]\n")
    assert message.startswith(f"rockingcan: this system is '{platform}', and it runs on Linux ")
    assert message.count("\n") == 1


@pytest.mark.parametrize(("given", "threads"), [(None, 1), ("2", 2)])
def test_linear_algebra_has_one_thread_unless_the_user_says_otherwise(
    given: str | None, threads: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    if given is not None:
        monkeypatch.setenv("OPENBLAS_NUM_THREADS", given)
    # threads that numpy starts when it is imported are there at the end
    program = (
        "import atexit, os, sys, rockingcan\n"
        "sys.argv = ['rockingcan', 'scenes', '--json']\n"
        "def told():\n"
        "    import numpy\n"
        "    print(len(os.listdir('/proc/self/task')), file=sys.stderr)\n"
        "atexit.register(told)\n"
        "rockingcan.main()"
    )
    code, _, message = started(tmp_path, "-c", program)
    assert (code, int(message)) == (0, min(threads, len(os.sched_getaffinity(0))))


@pytest.mark.parametrize("module", ["rockingcan", "harness"])
def test_folders_of_the_user_that_are_no_packages_are_in_nobodys_way(
    module: str, tmp_path: Path
) -> None:
    for name in ("models", "reference", "harness"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "notes.txt").touch()
    (tmp_path / "random.txt").touch()
    path = os.pathsep.join([str(tmp_path), str(ROOT)])
    assert started(tmp_path, "-m", module, "--version", path=path) == (0, VERSION, "")


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("harness.py", "harness"),
        ("models/__init__.py", "models"),
        ("reference/__init__.py", "reference"),
    ],
)
@pytest.mark.parametrize("by", ["python -m", "PYTHONPATH"])
def test_what_shadows_a_package_is_named(file: str, name: str, by: str, tmp_path: Path) -> None:
    (tmp_path / file).parent.mkdir(exist_ok=True)
    (tmp_path / file).write_text("raise SystemExit('the file of the user ran')", encoding="utf-8")
    if by == "python -m":
        code, said, message = started(tmp_path, "-m", "rockingcan", "--version")
    else:  # as the script that pip installs starts it, whose folder is no folder of the user's
        path = os.pathsep.join([str(tmp_path), str(ROOT)])
        program = "import sys; sys.path.remove(''); from rockingcan import main; main()"
        code, said, message = started(ROOT / "tests", "-c", program, path=path)
    assert (code, said) == (2, "")
    place = (tmp_path / file).resolve()
    assert message == (
        f"rockingcan: '{place}' stands before its own package '{name}'; take that folder out of "
        "PYTHONPATH, or start rockingcan by its name and not with python -m\n"
    )


def test_a_safe_path_needs_no_care(tmp_path: Path) -> None:
    (tmp_path / "harness.py").write_text("raise SystemExit('it ran')", encoding="utf-8")
    assert started(tmp_path, "-P", "-m", "harness", "--version") == (0, VERSION, "")
