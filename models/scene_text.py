"""The text of a scene file, written from a scene so that it reads back as the same scene."""

import json
from collections.abc import Mapping

from models.scene import Scene


def write_scene(scene: Scene) -> str:
    """Return the text of a scene file that reads back as an equal scene.

    Lengths and moments are written in SI units (`A`, `C`, `H`), all numbers to the last digit.
    """
    top: list[str] = []
    tables: list[str] = []
    for key, value in scene.to_dict().items():
        if isinstance(value, Mapping):
            tables.append(
                "\n".join(("", f"[{key}]", *(_assignment(*item) for item in value.items())))
            )
        else:
            top.append(_assignment(key, value))
    return "\n".join((*top, *tables)) + "\n"


def _assignment(key: str, value: object) -> str:
    return f"{key} = {_toml(value)}"


def _toml(value: object) -> str:
    """Return a value as TOML writes it: inline."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(_assignment(*item) for item in value.items()) + " }"
    if isinstance(value, str):  # printable, so every escape that JSON uses TOML knows too
        return json.dumps(value, ensure_ascii=False)
    return repr(value)
