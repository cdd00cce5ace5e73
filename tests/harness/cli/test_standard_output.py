"""Answers that cannot be written: one message and a code, in each way in which they are printed."""

import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.parametrize("words", [("scenes",), ("scenes", "--json"), ("--help",)], ids=" ".join)
def test_a_full_disk_behind_standard_output_is_one_message(words: tuple[str, ...]) -> None:
    source = str(Path(__file__).parents[3])
    program = f"import sys; sys.path.insert(0, {source!r}); from harness.cli import main; main()"
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        done = subprocess.run(  # noqa: S603 - our own program
            [sys.executable, "-c", program, *words],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=120,
            check=False,
        )
    assert done.returncode == 2
    told = "rockingcan: cannot write to standard output: No space left on device\n"
    assert done.stderr == told
