"""The promises of README and the first pages: examples run, commands exist, pictures are there."""

import re
from pathlib import Path

import pytest

from harness.cli.commands import COMMANDS
from models.scene_file import read_scene

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
START = (ROOT / "docs" / "start.md").read_text(encoding="utf-8")
USE = (ROOT / "docs" / "how-to" / "use.md").read_text(encoding="utf-8")


def _block(text: str, language: str) -> str:
    """Return the one code block of a language."""
    (block,) = re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)
    return str(block)


def test_the_python_example_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(_block(START, "python"), "start.md", "exec"), {})  # noqa: S102 - it is our own
    printed = capsys.readouterr().out
    assert printed.startswith("4.2322")  # rad: the angle of turn of gentle-rock, 242.49 degrees
    assert "max_slip_m_s" in printed
    assert (tmp_path / "gentle-rock.csv").stat().st_size > 0


def test_the_scene_file_is_one(tmp_path: Path) -> None:
    path = tmp_path / "my-can.toml"
    path.write_text(_block(USE, "toml"), encoding="utf-8")
    scene = read_scene(path)
    assert scene.name == "my-can"
    assert scene.effects.slip is not None


def test_the_commands_exist() -> None:
    blocks = "\n".join(re.findall(r"```\n(.*?)```", USE, flags=re.DOTALL))
    named = set(re.findall(r"^rockingcan (\w+)", blocks, flags=re.MULTILINE))
    existing = {str(command.name) for command in COMMANDS}
    assert named <= existing
    assert {"scenes", "engines", "reference", "run", "validate", "export"} <= named


def test_its_pictures_and_links_are_there() -> None:
    linked = [link for link in re.findall(r"\]\(([^)]+)\)", README) if "://" not in link]
    assert linked
    assert [link for link in linked if not (ROOT / link).is_file()] == []


def test_it_is_three_screens() -> None:
    assert len(README.splitlines()) <= 150  # the rest is in the site, where it has room


def test_no_figure_is_left_open() -> None:
    assert re.findall(r"^[A-Z_]{5,}$|\| [A-Z]+_[A-Z]+ \|", README, flags=re.MULTILINE) == []
