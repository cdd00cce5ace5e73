"""Scene files: TOML read into a `Scene`, with exact messages.

The shape of the file (keys and types) is checked by pydantic, the values by the classes of the
scene themselves. What is wrong is reported together, one line each, naming the file and the key.
"""

import tomllib
from collections.abc import Callable
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from models.can import Can
from models.effects import KINDS, Effects
from models.errors import InvalidValueError, ModelError, SceneFileError, shown
from models.quantity import positive
from models.scene import Horizon, Scene
from models.scene_tables import CanTable, FileTable, HorizonTable, Table
from models.state import Release

LARGEST_FILE = 1_000_000
"""Bytes; a scene takes a few hundred."""

MOST_PROBLEMS = 10
"""Problems of shape that are listed; a file with more is no scene file at all."""

T = TypeVar("T")


def read_scene(path: str | Path) -> Scene:
    """Read a scene file.

    Parameters
    ----------
    path : path of a TOML file

    Returns
    -------
    Scene

    Raises
    ------
    SceneFileError
        If it cannot be read, is not TOML, or does not describe a scene: first all wrong keys and
        types are reported, then of each table the first value out of its range.
    """
    path = Path(path)
    text = _text(path)
    try:
        file = FileTable.model_validate(tomllib.loads(text))
    except ValidationError as error:
        problems = [_sentence(detail) for detail in _told_once(error.errors())]
        if len(problems) > MOST_PROBLEMS:
            problems[MOST_PROBLEMS:] = [f"has {len(problems) - MOST_PROBLEMS} more such problems"]
        raise SceneFileError(path, problems) from None
    except tomllib.TOMLDecodeError as error:  # its message says the line and the column
        raise SceneFileError(path, [f"is not valid TOML: {error}"]) from None
    except RecursionError:
        raise SceneFileError(path, ["is not valid TOML: it is nested too deeply"]) from None
    except ValueError:  # the one value that tomllib does not refuse in its own words
        raise SceneFileError(path, ["holds an integer of more than 4300 digits"]) from None
    return _scene(path, file)


def _text(path: Path) -> str:
    """Return the text of the file."""
    try:
        if not path.exists():
            raise SceneFileError(path, ["there is no such file"])
        if not path.is_file():  # never open a pipe or a device: it may not end
            raise SceneFileError(path, ["is not a regular file"])
        with path.open("rb") as stream:
            content = stream.read(LARGEST_FILE + 1)
    except OSError as error:
        raise SceneFileError(path, [f"cannot be read: {error.strerror}"]) from None
    if len(content) > LARGEST_FILE:
        raise SceneFileError(path, [f"is larger than {LARGEST_FILE} bytes, which no scene needs"])
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise SceneFileError(path, [f"is not UTF-8 text (byte {error.start})"]) from None


def _told_once(details: list[ErrorDetails]) -> list[ErrorDetails]:
    """Leave out missing keys of a table of an effect with an unknown one: it is one of them."""
    misspelt = {detail["loc"][:-1] for detail in details if detail["type"] == "extra_forbidden"}
    return [
        detail
        for detail in details
        if detail["type"] != "missing"
        or detail["loc"][0] != "effects"
        or detail["loc"][:-1] not in misspelt
    ]


_KINDS = {float: "a number", int: "an integer", str: "a string"}
_REQUIRED = {
    "float_type": "a number",
    "int_type": "an integer",
    "string_type": "a string",
    "model_type": "a table",
}


def _sentence(detail: ErrorDetails) -> str:
    """Say in one sentence what pydantic found: the key, the value and what is allowed."""
    location = [str(part) for part in detail["loc"]]
    key = shown(".".join(location))
    if detail["type"] == "missing":
        annotation: Any = _table(location[:-1]).model_fields[location[-1]].annotation
        return f"key {key} is missing; it must be {_KINDS.get(annotation, 'a table')}"
    if detail["type"] == "extra_forbidden":
        allowed = list(_table(location[:-1]).model_fields)
        close = get_close_matches(location[-1], allowed, n=1)
        hint = f", did you mean '{close[0]}'?" if close else ";"
        return f"key {key} is unknown{hint} allowed are {', '.join(allowed)}"
    if detail["type"] == "float_type" and type(detail["input"]) is int:
        return f"key {key} is an integer that is too large for a double"
    required = _REQUIRED.get(detail["type"], f"valid: {detail['msg']}")
    return f"key {key} is {_found(detail['input'])}, but must be {required}"


def _found(value: object) -> str:
    """Return the value as its author wrote it, in TOML's words."""
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            return f"the string {shown(value)}"
        case dict():
            return "a table"
        case list():
            return "an array"
        case int() | float():
            return shown(value)
        case _:  # what is left of TOML are dates and times
            return f"the date or time {value}"


def _table(location: list[str]) -> type[BaseModel]:
    """Return the model of the table at this place of the file."""
    table: type[BaseModel] = FileTable
    for key in location:
        annotation: Any = table.model_fields[key].annotation
        table = next(
            kind
            for kind in (annotation, *getattr(annotation, "__args__", ()))
            if isinstance(kind, type) and issubclass(kind, BaseModel)
        )
    return table


def _scene(path: Path, file: FileTable) -> Scene:
    """Build the scene that the file describes."""
    problems: list[str] = []

    def built(prefix: str, build: Callable[[], T]) -> T | None:
        try:
            return build()
        except InvalidValueError as error:
            key = f"'{prefix}{error.key}'"
            problems.append(f"key {key} is {shown(error.value)}, but must be {error.allowed}")
        except ModelError as error:
            problems.append(str(error))
        return None

    can = built("can.", lambda: _can(file.can))
    release = built("release.", lambda: Release(**file.release.model_dump()))
    horizon = built("horizon.", lambda: _horizon(file.horizon))
    declared = {
        name: built(f"effects.{name}.", partial(_effect, name, constants))
        for name, constants in file.effects.model_dump(exclude_none=True).items()
    }
    if None in declared.values():
        raise SceneFileError(path, problems)
    effects = built("effects.", lambda: Effects(**declared))
    if can is None or release is None or horizon is None or effects is None:
        raise SceneFileError(path, problems)
    scene = built(
        "",
        lambda: Scene(
            name=file.name,
            cite=file.cite,
            gravity=file.gravity,
            can=can,
            release=release,
            effects=effects,
            horizon=horizon,
        ),
    )
    if scene is None:
        raise SceneFileError(path, problems)
    return scene


def _can(table: CanTable) -> Can:
    """Build the can; each length and moment is given as a group or in SI units, never both."""
    mass, radius = positive("mass", table.mass), positive("radius", table.radius)
    given: dict[str, tuple[str, float]] = {}
    in_si: dict[str, float] = {}
    for field, group, si, unit in (
        ("half_height", "h", "H", radius),
        ("transverse_inertia", "a", "A", mass * (radius * radius)),
        ("axial_inertia", "c", "C", mass * (radius * radius)),
    ):
        key = _given(table, "can", group, si)
        given[field] = (key, getattr(table, key))
        in_si[field] = positive(*given[field]) * (unit if key == group else 1.0)
    try:
        return Can(mass=mass, radius=radius, **in_si)
    except InvalidValueError as error:
        raise InvalidValueError(*given[error.key], error.allowed) from None


def _effect(name: str, constants: dict[str, float]) -> Any:  # noqa: ANN401 - of any kind
    """Build the effect of that name."""
    return KINDS[name](**constants)


def _horizon(table: HorizonTable) -> Horizon:
    _given(table, "horizon", "bounces", "seconds")
    return Horizon(bounces=table.bounces, seconds=table.seconds)


def _given(table: Table, name: str, *alternatives: str) -> str:
    """Return the one key of the alternatives that is given."""
    keys = [key for key in alternatives if getattr(table, key) is not None]
    if len(keys) == 1:
        return keys[0]
    found = "are both given" if keys else "are both missing"
    quoted = " and ".join(f"'{name}.{key}'" for key in alternatives)
    raise ModelError(f"keys {quoted} {found}, but exactly one of them must be there")
