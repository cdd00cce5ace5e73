"""Engines that live in an interpreter of their own.

What an engine says of itself is asked there once, and its cases run there, in a worker that ends
with the process that asks. What needs the world of an engine, such as its probes, is a function of
a module that is called there as a whole: `call_at_engine`.
"""

import time
from collections.abc import Callable, Sequence
from concurrent.futures import wait
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any, NoReturn, ParamSpec, TypeVar

from harness.core.case import Case, Value
from harness.core.environments import Environment, environment
from harness.core.errors import BrokenEngineError, HarnessError
from harness.core.simulation import Simulation
from harness.engines.base import Capabilities, Engine, EngineFeatures, Setting, features_of
from harness.execution.estimate import add_time_elsewhere
from harness.execution.isolated_pool import IsolatedProcessPool, background_worker
from harness.execution.limits import NO_LIMITS
from harness.execution.worker import Loss, LostTaskError, OtherSourcesError, WorkerStartError

P = ParamSpec("P")
T = TypeVar("T")

_MOST_ANSWERS = 2**14
"""Cases of which the timestep is known without asking again: more than any suite has."""


class BrokenEnvironmentError(BrokenEngineError):
    """The environment of an engine is gone, or its engine cannot be made there.

    Parameters
    ----------
    engine : str
    reason : str
    command : str
        Adds the environment again.
    """

    def __init__(self, engine: str, reason: str, command: str) -> None:
        super().__init__(engine, "", reason)
        self.args = engine, reason, command
        self.reason, self.command = " ".join(reason.split()), command

    def __str__(self) -> str:
        """Say how it is made again."""
        return (
            f"the environment of engine '{self.engine}' is broken ({self.reason}); to make it "
            f"again, run: rockingcan engines remove {self.engine} && {self.command}"
        )


class OtherProgramError(BrokenEnvironmentError):
    """The worker of an engine is of another version of the program than this process."""

    def __str__(self) -> str:
        """Say why that can be, and what to do."""
        return (
            f"the worker of engine '{self.engine}' is of another version of the program than this "
            f"process (sources {self.reason}): they were edited meanwhile; start the program again"
        )


def call_at_engine(name: str, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
    """Return the result of a function that is called in the process in which an engine lives.

    Parameters
    ----------
    name : str
        Of the engine: if it lives in an interpreter of its own, the function and its arguments are
        sent there; else it is called here.
    fn : callable
        Of a module of this program.

    Raises
    ------
    LostTaskError
        If the process there dies.
    BrokenEnvironmentError
        If there is none to be had.
    Exception
        Whatever the function raises.
    """
    chosen = environment(name)
    return fn(*args, **kwargs) if chosen is None else _call_there(chosen, None, fn, *args, **kwargs)


def _call_there(
    chosen: Environment,
    patience: float | None,
    fn: Callable[P, T],
    /,
    *args: P.args,
    **kwargs: P.kwargs,
) -> T:
    """Return the result of a function that is called in the worker of an environment.

    Raises
    ------
    LostTaskError
        If the process there dies, or is stopped since it takes longer than `patience`, s.
    BrokenEnvironmentError
        If there is none to be had.
    """
    pool = _workers.get(chosen)
    if pool is None:
        pool = _workers[chosen] = background_worker(NO_LIMITS, chosen)
    answer = pool.submit(_with_time, fn, *args, **kwargs)
    if not wait([answer], patience).done:
        pool.stop()
        _workers.pop(chosen, None)
        raise LostTaskError(Loss.HUNG, f"it does not answer within the {patience:g} s allowed")
    try:
        result, cpu = answer.result()
    except OtherSourcesError as error:
        raise OtherProgramError(chosen.name, error.reason, chosen.command) from error
    except WorkerStartError as error:
        raise BrokenEnvironmentError(chosen.name, error.reason, chosen.command) from error
    add_time_elsewhere(cpu)
    return result


def _with_time(fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> tuple[T, float]:
    """Return the result of a function, and the processor time that it took, s."""
    started = time.process_time()
    return fn(*args, **kwargs), time.process_time() - started


_workers: dict[Environment, IsolatedProcessPool] = {}
"""The worker of each environment, which ends with this process."""


Find = Callable[[str], Engine]
"""Returns an engine by its name: `harness.engines.registry.engine`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Told:
    """What an engine says of itself; `offered` has the names of features that are functions."""

    version: str
    capabilities: Capabilities
    settings: tuple[Setting, ...]
    features: EngineFeatures
    offered: frozenset[str]


@dataclass(frozen=True, slots=True)
class _MatchedThere:
    """The matched value of a setting as a function of the timestep, asked of the engine."""

    find: Find
    engine: str
    setting: str
    patience: float

    def __call__(self, timestep: float) -> Value:
        """Return the value for a timestep, s."""
        return _matched_at(self, timestep)


@lru_cache(maxsize=_MOST_ANSWERS)
def _matched_at(asked: _MatchedThere, timestep: float) -> Value:
    """Return the matched value of a setting for a timestep, s."""
    question = asked.find, asked.engine, asked.setting, timestep
    place = environment(asked.engine)
    if place is None:
        return _matched(*question)
    try:
        return _call_there(place, asked.patience, _matched, *question)
    except LostTaskError as error:
        raise BrokenEnvironmentError(place.name, error.reason, place.command) from error


def _matched(find: Find, name: str, setting: str, timestep: float) -> Value:
    """Return the matched value of a setting, where the engine is."""
    matched = next(one.matched for one in find(name).settings if one.name == setting)
    return matched(timestep) if callable(matched) else matched


def _ask(find: Find, name: str, patience: float) -> _Told:
    """Return what an engine says of itself, where it is."""
    chosen = find(name)
    features = features_of(chosen)
    offered = {f.name for f in fields(features) if callable(getattr(features, f.name))}
    nothing: dict[str, Any] = dict.fromkeys(offered)  # a function of an object stays with it
    return _Told(
        version=chosen.version,
        capabilities=chosen.capabilities,
        settings=tuple(
            replace(setting, matched=_MatchedThere(find, name, setting.name, patience))
            if callable(setting.matched)
            else setting
            for setting in chosen.settings
        ),
        features=replace(features, **nothing),
        offered=frozenset(offered),
    )


def _call(find: Find, name: str, method: str, *args: object) -> Any:  # noqa: ANN401 - the method's
    """Call a method of an engine, where it is."""
    return getattr(find(name), method)(*args)


class RemoteEngine:
    """An engine in an interpreter of its own, with the name of its environment.

    Parameters
    ----------
    place : Environment
    find : callable
        Returns the engine by its name, in the process in which it lives.
    patience : float
        Time in which it has to answer a question, s.

    Raises
    ------
    BrokenEnvironmentError
        If it cannot be asked.
    """

    def __init__(self, place: Environment, find: Find, patience: float) -> None:
        self.environment, self.name, self._find = place, place.name, find
        self._patience = patience
        try:
            told = _call_there(place, patience, _ask, find, place.name, patience)
        except LostTaskError as error:
            raise BrokenEnvironmentError(place.name, error.reason, place.command) from error
        except BrokenEnvironmentError:
            raise
        except Exception as error:
            reason = f"{getattr(error, 'reason', '') or f'{type(error).__name__}: {error}'}"
            raise BrokenEnvironmentError(place.name, reason, place.command) from error
        self.version, self.settings, self.capabilities = (
            told.version,
            told.settings,
            told.capabilities,
        )
        calls = {
            "export_settings": self._export_settings,
            "simulate_many": self._simulate_many,
        }
        for name in (feature.name for feature in fields(EngineFeatures)):
            offer = calls.get(name, self._elsewhere)
            setattr(self, name, offer if name in told.offered else getattr(told.features, name))

    def timestep(self, case: Case) -> float | None:
        """Return the timestep of a case, s; None for a solver that chooses its own."""
        return _timestep(self._find, self.environment, self._patience, case)

    def simulate(self, case: Case) -> Simulation:
        """Run a case to its horizon; numerical failure is its outcome."""
        done: Simulation = call_at_engine(self.name, _call, self._find, self.name, "simulate", case)
        return done

    def _simulate_many(self, cases: Sequence[Case]) -> Sequence[Simulation]:
        """Run cases together."""
        done: Sequence[Simulation] = call_at_engine(
            self.name, _call, self._find, self.name, "simulate_many", cases
        )
        return done

    def _export_settings(self, case: Case) -> str:
        """Return a case in the engine's own language."""
        return str(call_at_engine(self.name, _call, self._find, self.name, "export_settings", case))

    def _elsewhere(self, *args: object) -> NoReturn:
        """Refuse to hand over a world, which cannot leave its process.

        Raises
        ------
        WorldElsewhereError
        """
        del args
        raise WorldElsewhereError(self.name)


class WorldElsewhereError(HarnessError, TypeError):
    """The world of an engine is asked for outside of the process in which the engine lives."""

    def __init__(self, engine: str) -> None:
        super().__init__(engine)
        self.engine = engine

    def __str__(self) -> str:
        """Say what works."""
        return (
            f"engine '{self.engine}' lives in an interpreter of its own, which its worlds cannot "
            "leave: call what needs one there, by `call_at_engine`"
        )


@lru_cache(maxsize=_MOST_ANSWERS)
def _timestep(find: Find, place: Environment, patience: float, case: Case) -> float | None:
    """Return the timestep of a case, from the engine where it lives."""
    question = find, place.name, "timestep", case
    told: float | None = _call_there(place, patience, _call, *question)
    return told
