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
from models import load, write_scene


@dataclass(frozen=True)
class Answer:
    """What a command left: its exit code, and what it said where."""

    code: int
    out: str
    err: str

    def json(self) -> Any:  # noqa: ANN401 - JSON is of any type
        """Return standard output as the one JSON object that it must be."""

        def refuse(word: str) -> None:
            raise ValueError(f"{word} is not JSON")

        return json.loads(self.out, parse_constant=refuse)


Command = Callable[..., Answer]


@pytest.fixture
def told(capsys: pytest.CaptureFixture[str]) -> Command:
    """Return a function that runs a command in this process."""

    def run(*words: str) -> Answer:
        capsys.readouterr()
        code = code_of(list(words))
        said = capsys.readouterr()
        return Answer(code, said.out, said.err)

    return run


@pytest.fixture
def typed(tmp_path: Path) -> Command:
    """Return a function that runs a command as a process of its own, in an empty folder."""
    folder = tmp_path / "empty"
    folder.mkdir()
    source = str(Path(__file__).parents[3])
    program = f"import sys; sys.path.insert(0, {source!r}); from harness.cli import main; main()"

    def run(*words: str) -> Answer:
        done = subprocess.run(  # noqa: S603 - our own program
            [sys.executable, "-c", program, *words],
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert list(folder.iterdir()) == []
        return Answer(done.returncode, done.stdout, done.stderr)

    return run


@pytest.fixture
def scene_file(tmp_path: Path) -> Callable[..., Path]:
    """Return a function that writes the paper's release with some lines changed."""

    def write(*changes: tuple[str, str]) -> Path:
        path = tmp_path / "scene.toml"
        text = write_scene(load("paper-release"))
        for old, new in changes:
            lines = text.splitlines()
            hits = [n for n, line in enumerate(lines) if line.startswith(old)]
            assert len(hits) == 1, (old, text)
            lines[hits[0]] = new
            text = "\n".join(lines) + "\n"
        path.write_text(text, encoding="utf-8")
        return path

    return write
