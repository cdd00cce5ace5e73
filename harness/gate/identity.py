"""Which case a result belongs to, whatever version of an engine made it.

A case's digest names a version of its engine, so that results of two versions never share one. Here
they must meet: a case is what the suite designed, without the settings that a run put on top of it.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.case import Case
from models.scene import Scene


@dataclass(frozen=True, slots=True, kw_only=True, order=True)
class Identity:
    """A case by what was asked of it.

    Parameters
    ----------
    scene, engine, profile : str
    timestep : float
        s; zero for the profile's own, which may differ from version to version.
    options : str
        Settings of the suite's own on top of the profile, as `name=value`, with spaces between.
    """

    scene: str
    engine: str
    profile: str
    timestep: float = 0.0
    options: str = ""

    def label(self) -> str:
        """Return the case in a few words."""
        step = "its own timestep" if self.timestep == 0.0 else f"{self.timestep:g} s"
        return " ".join(
            word
            for word in (f"{self.scene} in {self.engine} ({self.profile}, {step})", self.options)
            if word
        )

    def to_dict(self) -> dict[str, Any]:
        """Return what a file says of it."""
        return {name: getattr(self, name) for name in self.__slots__}


def identity(case: Case) -> Identity:
    """Return the identity of a case as a suite designed it."""
    return Identity(
        scene=case.scene.name,
        engine=case.engine,
        profile=case.profile,
        timestep=case.timestep or 0.0,
        options=" ".join(f"{name}={value}" for name, value in case.options),
    )


def told_identity(told: Mapping[str, Any]) -> Identity:
    """Return the identity that a file tells.

    Raises
    ------
    KeyError, TypeError, ValueError
        If it tells none.
    """
    return Identity(
        scene=str(told["scene"]),
        engine=str(told["engine"]),
        profile=str(told["profile"]),
        timestep=float(told["timestep"]),
        options=str(told["options"]),
    )


def scene_digest(scene: Scene) -> str:
    """Return 16 hexadecimal digits that name the motion which a scene asks for.

    Name and citation do not move the can.
    """
    told = {k: v for k, v in scene.to_dict().items() if k not in {"name", "cite"}}
    text = json.dumps(told, sort_keys=True, default=repr)
    return hashlib.sha256(text.encode()).hexdigest()[:16]
