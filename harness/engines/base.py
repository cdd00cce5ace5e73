"""Engines as the harness sees them: capabilities, settings, and the method `simulate`.

`Engine` is the role that everything that moves a can plays; the smaller role of a compiled engine
model is `harness.engines.world`.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field, fields
from typing import TYPE_CHECKING, Any, Protocol

from harness.core.case import Case, Value
from harness.core.errors import InvalidSettingError, UnknownSettingError
from harness.core.public_paths import warn_renamed
from harness.core.simulation import Simulation
from harness.engines.description import Description, Precision
from harness.engines.linearised import LinearisedMotion
from harness.engines.world import World, renamed_words
from models.effects import Effects

if TYPE_CHECKING:
    from harness.engines.stepping.recording import Chunk


@dataclass(frozen=True, slots=True, kw_only=True)
class Capabilities:
    """Effects that an engine simulates, and effects that it adds.

    Parameters
    ----------
    honours : frozenset of str
        Effects that it simulates where a scene declares them, and constants such as
        "compliance.exponent" that it takes other than their defaults.
    imposes : mapping of str to str
        Effects that it adds to every scene, declared or not, each with a sentence that says how.
    least : mapping of str to float
        Constants of effects, such as "drilling.length", of which an engine makes a small one this
        large, SI units; none at all, where that is allowed, stays none.
    """

    honours: frozenset[str]
    imposes: Mapping[str, str]
    least: Mapping[str, float] = field(default_factory=dict)

    def lacking(self, effects: Effects) -> tuple[str, ...]:
        """Return what is declared that the engine neither honours nor imposes."""
        known = self.honours | set(self.imposes)
        return tuple(name for name in effects.demanded() if name not in known)


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting of an engine, under the engine's own name.

    Parameters
    ----------
    name : str
    default : Value
        What the engine ships with.
    matched : Value or callable
        What profile `matched` takes instead; a function of the timestep (s) where it depends on it.
    meaning : str
        One sentence: what it does to a rolling can.
    adaptive : Value
        What profile `adaptive` takes where it differs from `matched`.
    choices : tuple of str
        The words allowed, where the setting is a word.
    positive : bool
        Whether a number has to be greater than zero.
    unset : str
        What the engine does of its own accord where it is not handed the setting, `default` None.
    points : bool
        Whether the value is points, three numbers each.
    """

    name: str
    default: Value
    matched: Value | Callable[[float], Value]
    meaning: str
    _: KW_ONLY
    adaptive: Value = None
    choices: tuple[str, ...] = ()
    positive: bool = False
    unset: str = ""
    points: bool = False

    @classmethod
    def as_shipped(cls, name: str, value: Value, meaning: str, **allowed: Any) -> "Setting":  # noqa: ANN401 - the fields
        """Return a setting of which every profile takes the value that the engine ships with."""
        return cls(name, value, value, meaning, **allowed)


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelDifference:
    """A difference between an engine as shipped and matched: settings that change together.

    Parameters
    ----------
    name : str
        One or two words.
    settings : tuple of str
        Names of the settings that remove it; `TIMESTEP` stands for the timestep.
    sentence : str
        What the difference does to the can.
    """

    name: str
    settings: tuple[str, ...]
    sentence: str


TIMESTEP = "timestep"
"""Name of the timestep among settings; it is no setting of an engine but of a case."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SolverEffort:
    """The effort of an engine's solver in a step.

    Parameters
    ----------
    name : str
        In a few words, such as "2 iterations".
    settings : tuple of (str, Value)
    """

    name: str
    settings: tuple[tuple[str, Value], ...]


class Engine(Protocol):
    """Anything that moves a can; what an engine may offer besides is in `EngineFeatures`."""

    name: str
    capabilities: Capabilities
    settings: tuple[Setting, ...]

    @property
    def version(self) -> str:
        """The version of the engine's package."""

    def timestep(self, case: Case) -> float | None:
        """Return the timestep of a case, s; None for a solver that chooses its own."""

    def simulate(self, case: Case) -> Simulation:
        """Run a case to its horizon; numerical failure is its outcome."""


def resolve(
    case: Case,
    settings: tuple[Setting, ...],
    timestep: float,
    for_effects: Mapping[str, Value] | None = None,
) -> dict[str, Value]:
    """Return every setting in force for a case.

    Parameters
    ----------
    case : Case
        Its options replace the values of its profile, and those that its effects ask for.
    settings : tuple of Setting
    timestep : float
        s.
    for_effects : mapping of str to Value, optional
        The values that the effects of the scene ask for, in every profile.

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
    chosen |= for_effects or {}
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
    elif setting.points:
        fits = isinstance(value, tuple) and len(value) % 3 == 0 and all(map(_is_number, value))
        allowed = "points, three numbers each, with commas between them"
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


Options = tuple[tuple[str, Value], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Variant:
    """A choice of settings, to be run over a ladder.

    Parameters
    ----------
    name : str
        In a few words.
    profile : str
    settings : tuple of (str, Value)
        On top of the profile.
    along : str
        What the ladder changes: "timestep", "" for a single run, or the name of a setting.
    values : tuple
        Values of that setting, from coarse to fine; timesteps are chosen by the study.
    imposes : str
        What the settings make of the can that the scene does not declare; empty if nothing.
    thorough : bool
        Whether a quick look may do without it, since another variant says nearly the same.
    """

    name: str
    profile: str = "matched"
    settings: Options = ()
    along: str = "timestep"
    values: tuple[Value, ...] = ()
    imposes: str = ""
    thorough: bool = False

    @classmethod
    def of(cls, setting: str, value: Value, **more: Any) -> "Variant":  # noqa: ANN401 - the fields
        """Return the variant of one setting, which names it."""
        spelled = f"{value:g}" if isinstance(value, float) else value
        return cls(name=f"{setting} {spelled}", settings=((setting, value),), **more)


COMMON = (
    Variant(name="as shipped", profile="default", imposes="everything that the engine ships with"),
    Variant(name="matched"),
    Variant(name="adaptive", profile="adaptive"),
)
"""The variants with which every stepping engine is run."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EngineFeatures:
    """What an engine may offer beyond `Engine`; a feature that it leaves out has its default.

    Parameters
    ----------
    description : Description
    imposed_in : callable or None
        Returns the rows of parity in which the engine goes its own way in a case, each with the
        largest share of the declared by which it does.
    precision : callable or None
        Returns the precision of a case, where a setting chooses it.
    model_differences : tuple of ModelDifference
        In the order in which to remove them.
    solver_efforts : tuple of SolverEffort
        The last is the converged solve.
    colliders : tuple of Variant
        Settings that decide how contact points are found, for the probe of the rim.
    mesh_colliders : tuple of Variant
        Those for a can that is a mesh, of the setting `mesh`.
    variants : tuple of Variant, or None
        Settings worth a price; None takes the profiles and each word that a setting allows.
    tolerances : tuple of Variant
        Settings that ask for an accuracy of the motion, each with its values from coarse to fine,
        beside the accuracy setting of the description and the `eta` of adaptive stepping.
    linearise : callable or None
        Returns the motion of a case with its derivatives, as the engine differentiates itself: of a
        case, changes of the release (12, k), `seconds` of the run, and the `step` of differences
        that the engine takes, which one that differentiates its program has no use for.
    linearise_variants : tuple of Variant
        Settings with which its derivatives are asked for too: those of the profile may have none.
    export_settings : callable or None
        Returns a case in the engine's own language.
    counted_step : callable or None
        Steps a world and returns the iterations of its solver.
    simulate_many : callable or None
        Runs cases together, with the same results as one by one.
    open : callable or None
        Compiles a case into a world.
    chunks : callable or None
        Steps a world by a schedule, yielding after so many steps or more.
    bare_loop : callable or None
        Steps a world so many times and does nothing else.
    """

    description: Description = field(default_factory=Description)
    imposed_in: Callable[[Case], Mapping[str, float]] | None = None
    precision: Callable[[Case], Precision] | None = None
    model_differences: tuple[ModelDifference, ...] = ()
    solver_efforts: tuple[SolverEffort, ...] = ()
    colliders: tuple[Variant, ...] = (Variant(name="matched"),)
    mesh_colliders: tuple[Variant, ...] = ()
    variants: tuple[Variant, ...] | None = None
    tolerances: tuple[Variant, ...] = ()
    linearise: Callable[..., LinearisedMotion] | None = None
    linearise_variants: tuple[Variant, ...] = ()
    export_settings: Callable[[Case], str] | None = None
    counted_step: Callable[[World], int] | None = None
    simulate_many: Callable[[Sequence[Case]], Sequence[Simulation]] | None = None
    open: Callable[[Case], World] | None = None
    chunks: Callable[[Any, Any, int], Iterator["Chunk"]] | None = None
    bare_loop: Callable[[Any, int], None] | None = None


_RENAMED = {
    "model_differences": "gaps",
    "solver_efforts": "efforts",
    "export_settings": "paste",
    "bare_loop": "leanest",
}
"""Names of features in the previous release, accepted for one release more."""


def features_of(engine: Engine) -> EngineFeatures:
    """Return the optional features of an engine."""
    offered = {}
    for name in (feature.name for feature in fields(EngineFeatures)):
        old = _RENAMED.get(name, name)
        # a subclass with the old name inherits the default of the new name: the old name wins
        if old != name and hasattr(engine, old):
            warn_renamed(renamed_words(engine.name, old, name))
            offered[name] = getattr(engine, old)
        elif hasattr(engine, name):
            offered[name] = getattr(engine, name)
    return EngineFeatures(**offered)


def __getattr__(name: str) -> object:
    """Return a class under its name of the previous release, with a warning."""
    renamed = {"Gap": ModelDifference, "Effort": SolverEffort}
    if name not in renamed:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    warn_renamed(renamed_words(f"'{__name__}'", name, renamed[name].__name__))
    return renamed[name]
