"""The openable model files are those that the generator gives, byte for byte."""

import importlib
from pathlib import Path

import pytest

import models
from models.export import model_files, write_model_files

PACKAGE = Path(models.__file__).parent


def test_the_committed_files_equal_what_is_generated() -> None:
    # To write them anew: python -m models.export
    expected = {path.as_posix(): text.encode() for path, text in model_files()}
    found = {
        path.relative_to(PACKAGE).as_posix(): path.read_bytes()
        for folder in ("mjcf", "urdf")
        for path in (PACKAGE / folder).iterdir()
    }
    assert found.keys() == expected.keys()
    assert found == expected


def test_writing_them_anew_removes_those_of_scenes_that_are_gone(tmp_path: Path) -> None:
    write_model_files(tmp_path)
    stale = tmp_path / "mjcf" / "gone.xml"
    stale.write_text("")
    write_model_files(tmp_path)
    assert not stale.exists()
    for path, text in model_files():
        assert (tmp_path / path).read_bytes() == text.encode()


@pytest.mark.parametrize("name", ["mjcf", "urdf"])
def test_a_folder_of_model_files_is_no_module_in_the_place_of_the_function(name: str) -> None:
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module(f"models.{name}")
    assert callable(getattr(models, name))
