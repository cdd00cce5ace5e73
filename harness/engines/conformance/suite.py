"""The suite: its scenes, cases and shared runs, its clauses, and their results for an engine.

Every scene is the release `gentle-rock` of the catalogue: for 20 ms, of which every timestep is
recorded; through its bounce; or thrown so that it flies. A clause passes, fails or does not apply,
and says by which number. The clauses are in the modules of this package, whose order, and that of
the clauses in each, is the one in which they are worth reading.
"""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from enum import Enum
from functools import cache

from harness.core.case import Case, Value
from harness.core.simulation import Simulation
from harness.core.trajectory import Trajectory
from harness.engines import registry
from harness.engines.base import Engine, features_of
from harness.engines.contract import contract_violation
from harness.engines.description import Precision
from harness.engines.remote import RemoteEngine, call_at_engine
from harness.execution.worker import LostTaskError
from models import Horizon, Scene, load

COARSE = 1e-3
"""s: longer than the recorder's time step for the can of the suite, so that no step is left out."""

FINE = 1e-4
"""s: the bounce of the suite's scene is resolved."""

BRIEF = 0.02
"""s: long enough for a contact to come to rest, too short for the bounce."""


class BrokenContractError(Exception):
    """A run that is no simulation of its case; the message says why."""


class Fixture:
    """One engine under test.

    Parameters
    ----------
    engine : Engine
    """

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self.gentle: Scene = load("gentle-rock")
        self.brief: Scene = replace(self.gentle, horizon=Horizon(seconds=BRIEF))
        release = replace(self.gentle.release, phi_dot=60.0)  # the centre outruns the falling rim
        self.thrown: Scene = replace(self.gentle, release=release, horizon=Horizon(seconds=5e-3))
        self._runs: dict[Case, Simulation] = {}

    @property
    def steps(self) -> bool:
        """Whether the engine takes timesteps, rather than choosing its own."""
        return self.engine.timestep(Case(scene=self.brief, engine=self.engine.name)) is not None

    def case(self, scene: Scene | None = None, timestep: float = COARSE, **options: Value) -> Case:
        """Return a case of the engine, matched, of the brief release if no scene is given.

        The timestep is left out where the engine takes none.
        """
        return Case(
            scene=self.brief if scene is None else scene,
            engine=self.engine.name,
            timestep=timestep if self.steps else None,
            options=tuple(options.items()),
        )

    def precision(self, case: Case) -> Precision:
        """Return the precision in which the engine computes a case."""
        features = features_of(self.engine)
        chosen = features.precision
        return features.description.precision if chosen is None else chosen(case)

    def run(self, case: Case) -> Simulation:
        """Return a run of a case, the same one whenever it is asked for."""
        if case not in self._runs:
            self._runs[case] = self.run_anew(case)
        return self._runs[case]

    def run_anew(self, case: Case) -> Simulation:
        """Run a case.

        Raises
        ------
        BrokenContractError
            If the answer is no simulation of it.
        """
        answer = self.engine.simulate(case)
        reason = contract_violation(answer, case)
        if reason:
            raise BrokenContractError(reason)
        return answer

    def trajectory(self, case: Case | None = None) -> Trajectory:
        """Return the trajectory of a run, of the brief release if no case is given.

        Raises
        ------
        BrokenContractError
            If there is none.
        """
        simulation = self.run(self.case() if case is None else case)
        if simulation.trajectory is None:
            reason = f"no trajectory: {simulation.outcome.value} {simulation.note}".strip()
            raise BrokenContractError(reason)
        return simulation.trajectory


def fingerprint(simulation: Simulation) -> str:
    """Return a line that differs where a bit differs; times and cost are not in it."""
    digest = hashlib.sha256()
    if simulation.trajectory is not None:
        for field in fields(Trajectory):
            digest.update(getattr(simulation.trajectory, field.name).tobytes())
    return f"{simulation.outcome.name} {simulation.steps} {digest.hexdigest()}"


class ClauseStatus(Enum):
    """How a check ended."""

    PASSED = "passed"
    FAILED = "failed"
    NOT_APPLICABLE = "not applicable"


@dataclass(frozen=True, slots=True, kw_only=True)
class ClauseResult:
    """The result of one check.

    Parameters
    ----------
    name, sentence : str
        Of the clause; empty until `conform` puts them in.
    result : ClauseStatus
    number, allowed : float or None
        What was measured, and the most that passes; None where the answer is yes or no.
    unit : str
    detail : str
        What was looked at, or what was wrong.
    """

    name: str = ""
    sentence: str = ""
    result: ClauseStatus
    number: float | None = None
    allowed: float | None = None
    unit: str = ""
    detail: str = ""


def within(number: float, allowed: float, unit: str, detail: str) -> ClauseResult:
    """Return passed if a number is at most what is allowed; a number that is none fails."""
    result = ClauseStatus.PASSED if number <= allowed else ClauseStatus.FAILED
    return ClauseResult(result=result, number=number, allowed=allowed, unit=unit, detail=detail)


def holds(wrong: str, detail: str) -> ClauseResult:
    """Return failed with what is wrong, or passed with what was looked at if nothing is."""
    result = ClauseStatus.FAILED if wrong else ClauseStatus.PASSED
    return ClauseResult(result=result, detail=wrong or detail)


def same_bits(same: bool, wrong: str) -> ClauseResult:  # noqa: FBT001 - the one question
    """Return passed if the bits of two runs are the same, or failed with what differs."""
    return holds("" if same else wrong, "equal bits")


def not_applicable(why: str) -> ClauseResult:
    """Return that a check does not apply."""
    return ClauseResult(result=ClauseStatus.NOT_APPLICABLE, detail=why)


Look = Callable[[Fixture], ClauseResult]


@dataclass(frozen=True, slots=True, kw_only=True)
class Clause:
    """A promise of an adapter in a sentence, and the function that checks it.

    `needs_run` is false where there is something to look at though no run hands over a trajectory.
    `contact` is true where the promise is one of contacts, which a constraint does not make.
    """

    sentence: str
    look: Look
    needs_run: bool
    contact: bool


CLAUSES: dict[str, Clause] = {}
"""Every clause by its name, in the order in which they are worth reading."""


def clause(
    sentence: str, *, needs_run: bool = True, contact: bool = False
) -> Callable[[Look], Look]:
    """Return a decorator that registers a function as a clause of the function's name."""

    def registered(look: Look) -> Look:
        name = look.__name__.replace("_", " ")
        CLAUSES[name] = Clause(sentence=sentence, look=look, needs_run=needs_run, contact=contact)
        return look

    return registered


_RUNS = "trajectory"


def conform(
    engine: Engine, on_done: Callable[[str], None] | None = None
) -> tuple[ClauseResult, ...]:
    """Return the result of each clause for an engine.

    Parameters
    ----------
    engine : Engine
        Need not be registered; what needs a name in other processes is then not applicable.
    on_done : callable, optional
        Called with the name of each clause that was looked at.
    """
    look = _look_there if isinstance(engine, RemoteEngine) else _look
    fixture, results = Fixture(engine), list[ClauseResult]()
    refusal = features_of(engine).description.method.refusal
    runs = True
    for name, each in CLAUSES.items():
        if each.contact and refusal:
            result = not_applicable(refusal)
        elif runs or not each.needs_run:
            result = look(name, fixture)
        else:
            result = not_applicable(f"needs a run that passes the check '{_RUNS}'")
        if name == _RUNS:
            runs = result.result is ClauseStatus.PASSED
        results.append(replace(result, name=name, sentence=each.sentence))
        if on_done is not None:
            on_done(name)
    return tuple(results)


def _look(name: str, fixture: Fixture) -> ClauseResult:
    """Return the result of a clause; whatever the adapter raises is a failure of it."""
    try:
        return CLAUSES[name].look(fixture)
    except BrokenContractError as error:
        return ClauseResult(result=ClauseStatus.FAILED, detail=str(error))
    except Exception as error:  # noqa: BLE001 - the suite reports on any adapter to its end
        return holds(f"raised {type(error).__name__}: {error}", "")


def _look_there(name: str, fixture: Fixture) -> ClauseResult:
    """Return the result of a clause, looked at where the engine lives."""
    engine = fixture.engine.name
    try:
        return call_at_engine(engine, _look_here, name, engine)
    except LostTaskError as error:
        return ClauseResult(result=ClauseStatus.FAILED, detail=error.reason)


def _look_here(name: str, engine: str) -> ClauseResult:
    """Return the result of a clause for a registered engine; its runs serve the other clauses."""
    return _look(name, _fixture_of(engine))


@cache
def _fixture_of(name: str) -> Fixture:
    """Return the fixture of a registered engine."""
    return Fixture(registry.engine(name))
