"""Commands whose program is in the source checkout: its options, its codes, or where to get it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from harness.cli import checkout
from tests.support.command_line import Command


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("faults", "--help"), 0, "--kills"),
        (("benchmark", "--help"), 0, "--engine"),
        (("faults", "--only", "floods"), 2, "sweeps, kills, engines, disk, signals, worker"),
        (("benchmark", "--engine", "none-such"), 2, "unknown engine 'none-such'"),
        (("benchmark", "--floods"), 2, "No such option"),
    ],
)
def test_options_and_codes_are_those_of_the_program(
    words: tuple[str, ...], code: int, said: str, tmp_path: Path
) -> None:
    # in a folder that has tests of its own, as some packages bring them, which are not meant
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "__init__.py").touch()
    paths = (Path(__file__).parents[3], tmp_path)
    done = subprocess.run(  # noqa: S603 - our own program
        [sys.executable, "-c", "from harness.__main__ import main; main()", *words],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(map(str, paths))},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == code, done.stderr
    assert said in (done.stderr if code else done.stdout)
    assert (done.stdout if code else done.stderr) == ""


@pytest.mark.parametrize("name", ["faults", "benchmark"])
def test_an_installed_package_says_where_the_program_is(
    rockingcan: Command, name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(checkout, "_CHECKOUT", tmp_path)
    answer = rockingcan(name)
    assert answer.code == 2
    assert len(answer.err.splitlines()) == 1
    assert "source checkout" in answer.err
