"""What an engine is to the harness: capabilities, settings, and one verb.

`Engine` is the role that everything that moves a can plays. `World` is the smaller role of a
compiled engine model that can be placed, stepped and read; the probes of parity and the search for
the static penetration are written once, against it.

A run comes in chunks of consecutive steps, raw until somebody wants to look at a state.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from harness.core.case import Case, Value
from harness.core.errors import InvalidSettingError, UnknownSettingError
from harness.core.simulation import Simulation
from harness.core.trajectory import Floats as Floats_trajectory
from harness.core.trajectory import Integers, Trajectory
from models.state import Pose, Twist

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Capabilities:
    """What an engine makes of effects.

    Parameters
    ----------
    honours : frozenset of str
        Effects that it simulates where a scene declares them.
    imposes : mapping of str to str
        Effects that it adds to every scene, declared or not, each with a sentence that says how.
    least : mapping of str to float
        Constants of effects, such as "drilling.length", of which an engine makes a small one this
        large, SI units; none at all, where that is allowed, stays none.
    """

    honours: frozenset[str]
    imposes: Mapping[str, str]
    least: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """One setting of an engine, under the engine's own name.

    Parameters
    ----------
    name : str
    default : Value
        What the engine ships with.
    matched : Value or callable
        What profile `matched` takes instead; a function of the timestep (s) where it depends on it.
    adaptive : Value
        What profile `adaptive` takes where it differs from `matched`.
    choices : tuple of str
        The words allowed, where the setting is a word.
    positive : bool
        Whether a number has to be greater than zero.
    meaning : str
        One sentence: what it does to a rolling can.
    """

    name: str
    default: Value
    matched: Value | Callable[[float], Value]
    adaptive: Value = None
    choices: tuple[str, ...] = ()
    positive: bool = False
    meaning: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Gap:
    """One way in which an engine as it ships is not the matched one: settings that change together.

    Parameters
    ----------
    name : str
        One or two words.
    settings : tuple of str
        Names of the settings that close it; `TIMESTEP` stands for the timestep.
    sentence : str
        What the open gap does to the can.
    """

    name: str
    settings: tuple[str, ...]
    sentence: str


TIMESTEP = "timestep"
"""What a gap calls the timestep, which is no setting of an engine but of a case."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Effort:
    """How hard an engine's solver tries in a step.

    Parameters
    ----------
    name : str
        In a few words, such as "2 iterations".
    settings : tuple of (str, Value)
    """

    name: str
    settings: tuple[tuple[str, Value], ...]


class Engine(Protocol):
    """Anything that moves a can.

    An engine may also declare `gaps`, a tuple of `Gap` in the order in which to close them, and
    `efforts`, a tuple of `Effort` of which the last is the converged solve.
    """

    name: str
    capabilities: Capabilities
    settings: tuple[Setting, ...]

    @property
    def version(self) -> str:
        """The version of the engine's package."""
        ...

    def timestep(self, case: Case) -> float | None:
        """Return the timestep of a case, s; None for a solver that chooses its own."""
        ...

    def simulate(self, case: Case) -> Simulation:
        """Run a case to its horizon; numerical failure is its outcome."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Contact:
    """The contact at one instant: weighted point (3,), force (3,) on the can, depth, count."""

    point: Floats
    force: Floats
    penetration: float
    count: int


class World(Protocol):
    """A compiled engine model: one can, one plane, one timestep."""

    @property
    def mass(self) -> float:
        """Mass of the can, kg."""
        ...

    @property
    def inertia(self) -> Floats:
        """Principal moments in the order of the body's axes, shape (3,), kg m^2."""
        ...

    @property
    def timestep(self) -> float:
        """The timestep that was asked for, s."""
        ...

    def place(self, pose: Pose, twist: Twist) -> None:
        """Put the can somewhere, moving; forget what was before."""
        ...

    def step(self) -> None:
        """Advance by one timestep."""
        ...

    def pose(self) -> Pose:
        """Return where the can is."""
        ...

    def twist(self) -> Twist:
        """Return how the can moves."""
        ...

    def contact(self) -> Contact:
        """Return the contact that the last step solved: that of the state before it."""
        ...

    def gap(self) -> float:
        """Return the signed distance from the collider of the can to the plane, m."""
        ...


def resolve(case: Case, settings: tuple[Setting, ...], timestep: float) -> dict[str, Value]:
    """Return every setting in force for a case: the profile's, replaced by the case's options.

    Raises
    ------
    UnknownSettingError
        If an option has a name that the engine does not know.
    InvalidSettingError
        If an option has a value of another kind than the setting.
    """
    known = {setting.name: setting for setting in settings}
    chosen: dict[str, Value] = {}
    for name, setting in known.items():
        matched = setting.matched(timestep) if callable(setting.matched) else setting.matched
        if case.profile == "adaptive" and setting.adaptive is not None:
            matched = setting.adaptive
        chosen[name] = setting.default if case.profile == "default" else matched
    for name, value in case.options:
        if name not in known:
            raise UnknownSettingError(case.engine, name, known)
        chosen[name] = _checked(known[name], value, timestep)
    return chosen


def _checked(setting: Setting, value: Value, timestep: float) -> Value:
    """Return an option's value in the kind that its setting has, or refuse it."""
    matched = setting.matched(timestep) if callable(setting.matched) else setting.matched
    model = setting.default if setting.default is not None else matched
    model = setting.adaptive if model is None else model
    if value is None and setting.default is None:
        return None
    if setting.choices:
        fits, allowed = value in setting.choices, ", ".join(setting.choices)
    elif isinstance(model, bool):
        fits, allowed = isinstance(value, bool), "true or false"
    elif isinstance(model, str):
        fits, allowed = isinstance(value, str), "a word"
    elif isinstance(model, tuple):
        fits = isinstance(value, tuple) and len(value) == len(model) and all(map(_is_number, value))
        allowed = f"{len(model)} numbers with commas between them"
    elif isinstance(model, int):
        fits = isinstance(value, int) and not isinstance(value, bool) and value >= 0
        allowed = "an integer, zero or greater"
    else:
        fits = _is_number(value) and (not setting.positive or float(value) > 0.0)  # type: ignore[arg-type]
        allowed = "a finite number" + (" greater than zero" if setting.positive else "")
        value = float(value) if fits else value  # type: ignore[arg-type]
    if not fits:
        raise InvalidSettingError(setting.name, value, allowed)
    return value


def _is_number(value: object) -> bool:
    """Whether a value is a finite number, and not a truth value that passes for one."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Chunk:
    """Consecutive steps: the states before them with the contacts that they solved.

    An engine that pays for each reading may look at some of the steps only; each of those then
    stands for the steps up to the next.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Of the states that were read, each before its step, s.
    quaternions : ndarray, shape (m, 4)
        Of the first m states, scalar first; fewer than n if the engine's numbers broke.
    constraint_rows : ndarray of int, shape (n,)
        Rows that each of those steps solved for.
    sound : bool
        False if the engine's numbers broke within or right after these steps.
    read : callable
        Takes indices of the first m states and returns those states as a trajectory: most steps of
        a run are never looked at again.
    spans : ndarray of int, shape (n,), or None
        Steps that each reading stands for, its own the first; None where every step was read.
    """

    times: Floats_trajectory
    quaternions: Floats_trajectory
    constraint_rows: Integers
    sound: bool
    read: Callable[[Integers], Trajectory]
    spans: Integers | None = None
