"""A case: one scene in one engine with one choice of settings."""

import hashlib
import json
import math
import shlex
from collections.abc import Iterable
from dataclasses import dataclass

from harness.core.errors import InvalidSettingError
from models.scene import Scene

Value = float | int | str | bool | tuple[float, ...] | None
"""Value of an engine's setting; None leaves the engine as it ships."""

PROFILES = ("default", "matched", "adaptive")
"""`default`: the engine as it ships. `matched`: only what the scene declares, at a fixed timestep.
`adaptive`: matched, with timesteps that follow the motion; a timestep given is then the largest."""

RECORDED = "recorded"
"""In place of a profile: a program outside ran the case as it liked, and wrote a record."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """Scene + engine name + settings; hashable, picklable, with a stable digest.

    Parameters
    ----------
    scene : Scene
    engine : str
        Name under which the engine is registered.
    profile : str
        One of `PROFILES`: where the settings start from; or `RECORDED`.
    timestep : float, optional
        s; left out, the profile's own.
    options : tuple of (str, Value)
        Settings that replace the profile's, under the engine's own names, sorted by name. Of a
        record also its `file`, and how it is read: `--version`, `--column OURS`,
        `--convention PART`.

    Raises
    ------
    InvalidSettingError
        If the timestep is not positive and finite, or the profile is unknown.
    """

    scene: Scene
    engine: str
    profile: str = "matched"
    timestep: float | None = None
    options: tuple[tuple[str, Value], ...] = ()

    def __post_init__(self) -> None:
        """Refuse what no engine can run; put the options in one order."""
        if self.profile not in {*PROFILES, RECORDED}:
            raise InvalidSettingError("profile", self.profile, ", ".join(PROFILES))
        if self.timestep is not None and not (math.isfinite(self.timestep) and self.timestep > 0.0):
            raise InvalidSettingError("timestep", self.timestep, "a positive number of seconds")
        if self.timestep is not None:
            object.__setattr__(self, "timestep", float(self.timestep))
        object.__setattr__(self, "options", tuple(sorted(dict(self.options).items())))

    def digest(self, engine_version: str) -> str:
        """Return 16 hexadecimal digits that name this case in this version of its engine."""
        fields = {
            "type": type(self).__qualname__,
            "scene": self.scene.to_dict(),
            "engine": [self.engine, engine_version],
            "profile": self.profile,
            "timestep": self.timestep,
            "options": [[name, repr(value)] for name, value in self.options],
        }
        text = json.dumps(fields, sort_keys=True, default=repr)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    @property
    def shown_options(self) -> tuple[tuple[str, Value], ...]:
        """Options that a label shows: without how a record is read, whose names begin with `--`."""
        return tuple(option for option in self.options if not option[0].startswith("--"))

    def label(self) -> str:
        """Return the case in a few words, for progress bars and tables."""
        step = "" if self.timestep is None else f" dt={self.timestep:g}"
        options = "".join(f" {name}={_shortened(value)}" for name, value in self.shown_options)
        return f"{self.scene.name} {self.engine} {self.profile}{step}{options}"

    def command(self) -> str:
        """Return the command line that runs this case again."""
        options = dict(self.options)
        if self.profile == RECORDED:
            file = shlex.quote(_spell(options.pop("file", "FILE")))
            words = ["rockingcan score", self.scene.name, file]
            words.append(f"--name {shlex.quote(self.engine)}")
            own = [_score_option(name, _spell(value)) for name, value in options.items()]
            step = [] if self.timestep is None else [f"--timestep {self.timestep!r}"]
            return " ".join([*words, *step, *own])
        settings = [f"{name}={_spell(value)}" for name, value in options.items()]
        return run_command(self.scene.name, self.engine, self.profile, self.timestep, settings)


def _score_option(name: str, value: str) -> str:
    """Return an option of `score`: how the record is read, or a setting of its program."""
    if not name.startswith("--"):
        return f"--settings {shlex.quote(f'{name}={value}')}"
    option, _, key = name.partition(" ")
    return f"{option} {shlex.quote(f'{key}={value}' if key else value)}"


def run_command(
    scene: str, engine: str, profile: str, timestep: float | None, settings: Iterable[str]
) -> str:
    """Return the command line that runs a case; settings as `name=value`."""
    words = ["rockingcan run", scene, f"--engine {engine}", f"--profile {profile}"]
    if timestep is not None:
        words.append(f"--timestep {timestep!r}")
    return " ".join([*words, *(f"--set {setting}" for setting in settings)])


_MOST_NUMBERS = 6


def _shortened(value: Value) -> Value:
    """Return a value, or how many numbers it has if they are many."""
    many = isinstance(value, tuple) and len(value) > _MOST_NUMBERS
    return f"({len(value)} numbers)" if many else value  # type: ignore[arg-type] # a tuple


def _spell(value: Value) -> str:
    """Return a value as `--set` reads it."""
    if isinstance(value, tuple):
        return ",".join(repr(number) for number in value)
    return "none" if value is None else str(value)
