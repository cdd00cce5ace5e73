"""Running the command line: within this process, or as a user does."""

import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from harness.cli.main import code_of
from harness.engines import registry
from models import load, write_scene

_ROOT = Path(__file__).parents[2]

WRONG_USE = 2
"""Exit code of what cannot be done as it was asked for."""

INSTALLED = tuple(name for name in registry.names() if name not in registry.not_installed())
"""Engines that can be asked for, the exact motion among them."""


@dataclass(frozen=True)
class Answer:
    """What a command left: its exit code, and what it said where."""

    code: int
    out: str
    err: str

    def json(self) -> Any:
        """Return standard output as the one JSON object that it must be."""

        def refuse(word: str) -> None:
            raise ValueError(f"{word} is not JSON")

        return json.loads(self.out, parse_constant=refuse)


Command = Callable[..., Answer]
"""Runs a command of these words."""


def run_here(capsys: pytest.CaptureFixture[str], *words: object) -> Answer:
    """Run a command in this process."""
    capsys.readouterr()
    code = code_of([str(word) for word in words])
    said = capsys.readouterr()
    return Answer(code, said.out, said.err)


def run_as_process(folder: Path, *words: object) -> Answer:
    """Run a command as a process of its own, in an empty folder, where it leaves nothing."""
    program = (
        f"import sys; sys.path.insert(0, {str(_ROOT)!r}); from harness.cli import main; main()"
    )
    done = subprocess.run(  # noqa: S603 - our own program
        [sys.executable, "-c", program, *map(str, words)],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert list(folder.iterdir()) == []
    return Answer(done.returncode, done.stdout, done.stderr)


def write_scene_file(path: Path, *changes: tuple[str, str]) -> Path:
    """Write the paper's release with some lines changed: the start of each, and the new line."""
    lines = write_scene(load("paper-release")).splitlines()
    for old, new in changes:
        hits = [n for n, line in enumerate(lines) if line.startswith(old)]
        assert len(hits) == 1, (old, lines)
        lines[hits[0]] = new
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def able(effect: str) -> str:
    """Return what is said of the engines that can represent an effect."""
    names = (n for n in INSTALLED if effect in registry.engine(n).capabilities.honours)
    return f"engines that can: {', '.join(names)}"


def is_one_clear_message(answer: Answer, *parts: str) -> None:
    """Assert that an answer is one message with these parts, and nothing else."""
    assert answer.code == WRONG_USE, answer
    assert answer.out == ""
    assert answer.err.startswith("rockingcan: ")
    assert len(answer.err.strip().splitlines()) == 1, answer.err
    assert "Traceback" not in answer.err
    for part in parts:
        assert part in answer.err, (part, answer.err)
