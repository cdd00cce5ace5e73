"""The README's promises: its Python example runs, its scene file is one, its commands exist."""

import re
from pathlib import Path

import pytest

from harness.cli.commands import COMMANDS
from models.scene_file import read_scene

README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")


def _block(language: str) -> str:
    """Return the one code block of a language."""
    (block,) = re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)
    return str(block)


def test_the_python_example_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(_block("python"), "README.md", "exec"), {})  # noqa: S102 - it is our own
    printed = capsys.readouterr().out
    assert printed.startswith("4.2322")  # rad: the angle of turn of gentle-rock, 242.49 degrees
    assert "max_slip_m_s" in printed
    assert (tmp_path / "gentle-rock.csv").stat().st_size > 0


def test_the_scene_file_is_one(tmp_path: Path) -> None:
    path = tmp_path / "my-can.toml"
    path.write_text(_block("toml"), encoding="utf-8")
    scene = read_scene(path)
    assert scene.name == "my-can"
    assert scene.effects.slip is not None


def test_the_commands_exist() -> None:
    blocks = "\n".join(re.findall(r"```\n(.*?)```", README, flags=re.DOTALL))
    named = set(re.findall(r"^rockingcan (\w+)", blocks, flags=re.MULTILINE))
    existing = {str(command.name) for command in COMMANDS}
    assert named <= existing
    assert {"scenes", "engines", "reference", "run", "validate", "export"} <= named


def test_its_pictures_and_links_are_there() -> None:
    root = Path(__file__).parent.parent
    linked = [link for link in re.findall(r"\]\(([^)]+)\)", README) if "://" not in link]
    assert linked
    assert [link for link in linked if not (root / link).is_file()] == []


def test_no_figure_is_left_open() -> None:
    assert re.findall(r"^[A-Z_]{5,}$|\| [A-Z]+_[A-Z]+ \|", README, flags=re.MULTILINE) == []
