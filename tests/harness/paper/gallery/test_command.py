"""`rockingcan gallery` writes each figure twice, and a page."""

from pathlib import Path

import pytest

from harness.cli.paper import gallery
from harness.core.writing import ForeignFolderError
from harness.paper.gallery import FIGURES


@pytest.mark.slow
def test_the_gallery_is_written(tmp_path: Path) -> None:
    gallery(tmp_path / "gallery")
    folder = tmp_path / "gallery" / "figures"
    names = {path.stem for path in folder.glob("*.png")}
    assert len(names) == len(FIGURES)
    assert names == {path.stem for path in folder.glob("*.svg")}
    page = (tmp_path / "gallery" / "index.html").read_text(encoding="utf-8")
    assert "The figures of the paper" in page


def test_a_folder_of_somebody_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(ForeignFolderError):
        gallery(tmp_path)
