"""A simulation of a case: its outcome, its motion, and what it cost."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from functools import partial
from types import MappingProxyType
from typing import Any

from harness.core.case import Case, Value
from harness.core.trajectory import Trajectory


class Outcome(Enum):
    """How a simulation ended; the value is the sentence that a person reads."""

    FINISHED = "finished: the run reached its horizon"
    ENDED_EARLY = "ended early: the record stops before the end that the scene asks for"
    TIMED_OUT = "timed out: the can did not complete its bounces in the time allowed for them"
    FLAT = "flat: the can came to lie flat and did not rise again"
    OVERTURNED = "overturned: the can tipped over onto its side"
    TOO_SLOW = "too slow: the run took more steps than are allowed for it"
    DIVERGED = "diverged: the engine's numbers grew without bound or were no numbers"
    MISMATCH = "mismatch: the engine's model is not the scene's; see the parity table"
    NO_SOLUTION = "no solution: the exact equations end before the horizon"
    BROKEN = "broken: the engine's adapter did not keep its contract; see the note"
    CRASHED = "crashed: the engine took its process with it; see the note"
    HUNG = "hung: the engine was stopped at the time allowed for a case; see the note"
    OUT_OF_MEMORY = "out of memory: the engine was stopped at the memory allowed; see the note"
    STOPPED = "stopped: the process of the case was ended from outside; see the note"


@dataclass(frozen=True, slots=True)
class ParityRow:
    """One property of the compiled model and the value that the scene declares."""

    quantity: str
    unit: str
    declared: float
    found: float
    how: str
    verdict: str  # "equal", "imposed", "mismatch" or "does not apply"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Simulation:
    """A case with its outcome and its motion.

    Parameters
    ----------
    note : str
        Details of the outcome; may be empty.
    trajectory : Trajectory or None
        None if there is no motion to show.
    model : str
        The engine's name, or the name of the reference model.
    timestep : float or None
        s; None for a solver that chooses its own.
    settings : mapping
        Every setting in force, under the engine's own names.
    steps, constraint_rows : int
        Counts of work, which do not depend on the machine.
    compile_s : float
        Time to compile the engine's own program, by the clock: of one that does so on first use,
        in the first run of a process.
    setup_s, wall_s, cpu_s : float
        Time to compile the model and probe it; time of the steps, by the clock and of the
        processor.
    static_penetration : float
        Depth at which the can was released so that the contact starts at rest, m.
    """

    case: Case
    outcome: Outcome
    note: str = ""
    trajectory: Trajectory | None
    engine_version: str
    model: str
    timestep: float | None = None
    settings: Mapping[str, Value] = field(default_factory=dict)
    parity: tuple[ParityRow, ...] = ()
    steps: int = 0
    constraint_rows: int = 0
    compile_s: float = 0.0
    setup_s: float = 0.0
    wall_s: float = 0.0
    cpu_s: float = 0.0
    static_penetration: float = 0.0

    def __post_init__(self) -> None:
        """Lock the settings."""
        object.__setattr__(self, "settings", MappingProxyType(dict(self.settings)))

    @property
    def digest(self) -> str:
        """Return the digest of the case in this version of its engine."""
        return self.case.digest(self.engine_version)

    @property
    def ending(self) -> str:
        """Return the outcome's sentence, and the note if there is one."""
        return self.outcome.value + (f" ({self.note})" if self.note else "")

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle by the fields: a locked mapping cannot be pickled as it is."""
        values = {name: getattr(self, name) for name in self.__slots__}
        values["settings"] = dict(self.settings)
        return partial(Simulation, **values), ()
