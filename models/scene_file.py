"""Scene files: TOML read into a `Scene` with exact messages, and written back.

The shape of the file (keys and types) is checked by pydantic, the values by the classes of the
scene themselves. What is wrong is reported together, one line each, naming the file and the key.
"""

import json
import tomllib
from collections.abc import Callable, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

from models.can import Can
from models.effects import Effects, Slip
from models.errors import InvalidValueError, SceneFileError, shown
from models.quantity import positive
from models.scene import Horizon, Scene
from models.state import Release

LARGEST_FILE = 1_000_000
"""Bytes; a scene takes a few hundred."""

T = TypeVar("T")


class _Table(BaseModel):
    """A table of a scene file: no key beyond those named, no conversion of types."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class _Can(_Table):
    mass: float
    radius: float
    a: float | None = None
    A: float | None = None
    c: float | None = None
    C: float | None = None
    h: float | None = None
    H: float | None = None


class _Release(_Table):
    phi: float
    psi: float = 0.0
    theta: float = 0.0
    phi_dot: float = 0.0
    psi_dot: float = 0.0
    theta_dot: float = 0.0


class _Horizon(_Table):
    bounces: int | None = None
    seconds: float | None = None


class _Slip(_Table):
    mu: float


class _Effects(_Table):
    slip: _Slip | None = None


class _File(_Table):
    name: str
    cite: str = ""
    gravity: float
    can: _Can
    release: _Release
    horizon: _Horizon
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
    try:
        tables = tomllib.loads(_text(path))
    except (ValueError, RecursionError) as error:  # tomllib's own error is a ValueError
        raise SceneFileError(path, [f"is not valid TOML: {error}"]) from None
    try:
        file = _File.model_validate(tables)
    except ValidationError as error:
        raise SceneFileError(path, [_sentence(detail) for detail in error.errors()]) from None
    return _scene(path, file)


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


_KINDS = {
    "float_type": "a number",
    "int_type": "an integer",
    "string_type": "a string",
    "model_type": "a table",
}


def _sentence(detail: ErrorDetails) -> str:
    """Say in one sentence what pydantic found: the key, the value and what is allowed."""
    location = [str(part) for part in detail["loc"]]
    key = ".".join(location)
    if detail["type"] == "missing":
        return f"key '{key}' is missing"
    if detail["type"] == "extra_forbidden":
        allowed = list(_table(location[:-1]).model_fields)
        close = get_close_matches(location[-1], allowed, n=1)
        hint = f", did you mean '{close[0]}'" if close else ""
        return f"key '{key}' is unknown{hint}; allowed are {', '.join(allowed)}"
    kind = _KINDS.get(detail["type"], f"such that {detail['msg']}")
    found = {dict: "a table", list: "an array", str: "the string ", bool: "the boolean "}
    value = detail["input"]
    described = found.get(type(value), "")
    if not isinstance(value, dict | list):
        described += shown(value)
    return f"key '{key}' is {described}, but must be {kind}"


def _table(location: list[str]) -> type[BaseModel]:
    """Return the model of the table at this place of the file."""
    table: type[BaseModel] = _File
    for key in location:
        annotation: Any = table.model_fields[key].annotation
        table = next(
            kind
            for kind in (annotation, *getattr(annotation, "__args__", ()))
            if isinstance(kind, type) and issubclass(kind, BaseModel)
        )
    return table


def _scene(path: Path, file: _File) -> Scene:
    """Build the scene that the file describes."""
    problems: list[str] = []

    def built(prefix: str, build: Callable[[], T]) -> T | None:
        try:
            return build()
        except InvalidValueError as error:
            key = prefix + error.key
            problems.append(f"key '{key}' is {shown(error.value)}, but must be {error.allowed}")
            return None

    can = built("can.", lambda: _can(file.can))
    release = built("release.", lambda: Release(**file.release.model_dump()))
    horizon = built("", lambda: Horizon(**file.horizon.model_dump()))
    slip = file.effects.slip
    effects = built(
        "effects.slip.", lambda: Effects(slip=None if slip is None else Slip(mu=slip.mu))
    )
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


def _can(table: _Can) -> Can:
    """Build the can; each length and moment is given as a group or in SI units, never both."""
    mass, radius = positive("mass", table.mass), positive("radius", table.radius)
    given: dict[str, tuple[str, float]] = {}
    in_si: dict[str, float] = {}
    for field, group, si, unit in (
        ("half_height", "h", "H", radius),
        ("transverse_inertia", "a", "A", mass * radius**2),
        ("axial_inertia", "c", "C", mass * radius**2),
    ):
        keys = [key for key in (group, si) if getattr(table, key) is not None]
        if len(keys) != 1:
            found = "given twice" if keys else "missing"
            raise InvalidValueError(f"{group}` or `{si}", found, "given, exactly one of them")
        given[field] = (keys[0], getattr(table, keys[0]))
        in_si[field] = positive(*given[field]) * (unit if keys[0] == group else 1.0)
    try:
        return Can(mass=mass, radius=radius, **in_si)
    except InvalidValueError as error:
        raise InvalidValueError(*given[error.key], error.allowed) from None
