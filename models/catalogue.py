"""The scenes that come with the package, by name, and any other by the path of its file."""

import os
from importlib.resources import as_file, files
from pathlib import Path

from models.errors import UnknownSceneError
from models.scene import Scene
from models.scene_file import read_scene

_SUFFIX = ".toml"


def names() -> tuple[str, ...]:
    """Return the names of the scenes in the catalogue, sorted."""
    return tuple(
        sorted(
            entry.name.removesuffix(_SUFFIX)
            for entry in files("models").joinpath("scenes").iterdir()
            if entry.name.endswith(_SUFFIX)
        )
    )


def load(name_or_path: str | Path) -> Scene:
    """Return a scene of the catalogue, or the one that a file describes.

    Parameters
    ----------
    name_or_path : str or Path
        A name of the catalogue, which comes first, or the path of a scene file.

    Returns
    -------
    Scene

    Raises
    ------
    UnknownSceneError
        If it is neither; the message lists the catalogue.
    SceneFileError
        If the file does not describe a scene.
    """
    if isinstance(name_or_path, str):
        if name_or_path in names():
            entry = files("models").joinpath("scenes", name_or_path + _SUFFIX)
            with as_file(entry) as path:
                return read_scene(path)
        if not _looks_like_a_path(name_or_path):
            raise UnknownSceneError(name_or_path, names())
    return read_scene(name_or_path)


def _looks_like_a_path(text: str) -> bool:
    """Whether the text is meant as a path: it has a separator or a suffix, or there is a file."""
    if text.endswith(_SUFFIX) or os.sep in text:
        return True
    try:
        return Path(text).is_file()
    except OSError:  # too long for a path, so it is none
        return False
