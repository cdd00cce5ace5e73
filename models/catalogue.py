"""The scenes that come with the package, by name, and any other by the path of its file.

The hard cases of the stability study are scenes too, in a list of their own for that study, and so
are those of the field guide.
"""

import os
from importlib.resources import as_file, files
from pathlib import Path

from models.errors import UnknownSceneError
from models.scene import Scene
from models.scene_file import read_scene

_SUFFIX = ".toml"
_SCENES, _HARD, _FIELD = "scenes", "scenes/hard", "scenes/field"


def names() -> tuple[str, ...]:
    """Return the names of the scenes in the catalogue, sorted."""
    return _in(_SCENES)


def hard_names() -> tuple[str, ...]:
    """Return the names of the hard cases, sorted."""
    return _in(_HARD)


def field_names() -> tuple[str, ...]:
    """Return the names of the scenes of the field guide, sorted."""
    return _in(_FIELD)


def _in(folder: str) -> tuple[str, ...]:
    """Return the names of the scene files in a folder of the package, sorted."""
    return tuple(
        sorted(
            entry.name.removesuffix(_SUFFIX)
            for entry in files("models").joinpath(folder).iterdir()
            if entry.name.endswith(_SUFFIX)
        )
    )


def load(name_or_path: str | Path) -> Scene:
    """Return a scene of the catalogue, or the one that a file describes.

    Parameters
    ----------
    name_or_path : str or Path
        A name of the catalogue, of a hard case or of the field guide, which comes first, or the
        path of a scene file.

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
        for folder in (_SCENES, _HARD, _FIELD):
            if name_or_path in _in(folder):
                with as_file(files("models").joinpath(folder, name_or_path + _SUFFIX)) as path:
                    return read_scene(path)
        if not _looks_like_a_path(name_or_path):
            raise UnknownSceneError(name_or_path, names())
    return read_scene(name_or_path)


def _looks_like_a_path(text: str) -> bool:
    """Return whether a text is a path: it has a separator or a suffix, or is a file's name."""
    if text.endswith(_SUFFIX) or os.sep in text:
        return True
    try:
        return Path(text).is_file()
    except OSError:  # too long for a path, so it is none
        return False
