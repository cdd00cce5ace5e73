"""Scene files: TOML read into a `Scene`, with exact messages, and written from one.

The shape of the file (keys and types) is checked by pydantic, which neither converts nor ignores;
the values by the classes of the scene themselves. What is wrong is reported together, one line
each, naming the file and the key.
"""

import json
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError, create_model
from pydantic_core import ErrorDetails

from models.can import Can
from models.effects import KINDS, Effects
from models.errors import InvalidValueError, ModelError, SceneFileError, did_you_mean, shown
from models.quantity import positive
from models.release import Release
from models.scene import Horizon, Scene

LARGEST_FILE = 1_000_000
"""Bytes; a scene takes a few hundred."""

MOST_PROBLEMS = 10
"""Problems of shape that are listed; a file with more is no scene file at all."""

T = TypeVar("T")


class Table(BaseModel):
    """A table of a scene file: no key beyond those named, no conversion of types."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class CanTable(Table):
    """The can: mass, radius, and each moment and length as a group or in SI units."""

    mass: float
    radius: float
    a: float | None = None
    A: float | None = None
    c: float | None = None
    C: float | None = None
    h: float | None = None
    H: float | None = None


class ReleaseTable(Table):
    """How it is let go, rad and rad/s; the height in m."""

    phi: float
    psi: float = 0.0
    theta: float = 0.0
    phi_dot: float = 0.0
    psi_dot: float = 0.0
    theta_dot: float = 0.0
    height: float = 0.0


class HorizonTable(Table):
    """When to stop: one of the two."""

    bounces: int | None = None
    seconds: float | None = None


def _of_effects() -> type[Table]:
    """Return the table of effects: a table for each, with a key for each constant of its law."""
    tables: dict[str, Any] = {}
    for name, kind in KINDS.items():
        keys: dict[str, Any] = {
            key.name: (
                # a law is one of several words; every other constant is a number
                str if isinstance(key.default, str) else float,
                ... if key.default is MISSING else key.default,
            )
            for key in fields(kind)
        }
        tables[name] = (create_model(f"_{kind.__name__}", __base__=Table, **keys) | None, None)
    return create_model("_Effects", __base__=Table, **tables)


class _Effects(_of_effects()):  # type: ignore[misc] # a base that is made, not written
    """The table of effects."""


class FileTable(Table):
    """A scene file."""

    name: str
    cite: str = ""
    gravity: float
    can: CanTable
    release: ReleaseTable
    horizon: HorizonTable
    effects: _Effects = _Effects()


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
        details = _once(error.errors())
        problems = [_sentence(detail) for detail in details]
        keys = [".".join(map(str, detail["loc"])) for detail in details]
        if len(problems) > MOST_PROBLEMS:
            problems[MOST_PROBLEMS:] = [f"has {len(problems) - MOST_PROBLEMS} more such problems"]
            keys[MOST_PROBLEMS:] = [""]
        raise SceneFileError(path, problems, keys) from None
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


def _once(details: list[ErrorDetails]) -> list[ErrorDetails]:
    """Leave out a missing key that an unknown one of its table stands for: that one is misspelt."""

    def keys(kind: str, table: tuple[int | str, ...]) -> list[str]:
        at = [detail["loc"] for detail in details if detail["type"] == kind]
        return [str(location[-1]) for location in at if location[:-1] == table]

    def misspelt(location: tuple[int | str, ...]) -> bool:
        unknown = keys("extra_forbidden", location[:-1])
        every = len(unknown) >= len(keys("missing", location[:-1]))
        return every or bool(get_close_matches(str(location[-1]), unknown))

    return [d for d in details if d["type"] != "missing" or not misspelt(d["loc"])]


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
        hint = did_you_mean(location[-1], allowed)
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
    keys: list[str] = []

    def built(prefix: str, build: Callable[[], T]) -> T | None:
        try:
            return build()
        except InvalidValueError as error:
            keys.append(f"{prefix}{error.key}")
            problems.append(
                f"key '{keys[-1]}' is {shown(error.value)}, but must be {error.allowed}"
            )
        except ModelError as error:
            keys.append(prefix.removesuffix("."))
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
        raise SceneFileError(path, problems, keys)
    effects = built("effects.", lambda: Effects(**declared))
    if can is None or release is None or horizon is None or effects is None:
        raise SceneFileError(path, problems, keys)
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
        raise SceneFileError(path, problems, keys)
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


def _effect(name: str, constants: dict[str, float | str]) -> Any:  # noqa: ANN401 - of any kind
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
