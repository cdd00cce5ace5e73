"""The shape of a scene file: which keys each table has, and of which type.

Read by pydantic, which neither converts nor ignores. Ranges are checked by the classes of the
scene themselves.
"""

from dataclasses import MISSING, fields
from typing import Any

from pydantic import BaseModel, ConfigDict, create_model

from models.effects import KINDS


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
            key.name: (float, ... if key.default is MISSING else key.default)
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
