"""How long work will take: what tasks are expected to cost, corrected by those that are done.

Each task has an effort, in seconds of processor on a usual machine, and a group whose efforts are
wrong by one factor, such as the runs of an engine in a profile. Cases differ by orders of
magnitude, so that their number says little; the sum of their efforts, times the factor of their
group, says how much processor time is left. What the clock makes of it depends on the cores, and on
what else runs on them.

Before a group is known its factor is that of all others, and before anything is known that of the
last run with the same store; else one.
"""

import json
import math
import os
import time
from collections import defaultdict
from collections.abc import Hashable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.core.provenance import processor
from harness.execution.atomic_write import write_atomically

FILE = "speeds.json"
"""In a store: by processor and group, seconds taken for each second of effort."""

_FEW = 50
"""Tasks, of which the longest may take longer than a core's share of all."""

_SAID = 10.0
"""s: work that takes less is over before an estimate is read."""


@dataclass(frozen=True, slots=True)
class Taken:
    """What a task took, s: processor time and time by the clock."""

    cpu: float
    wall: float


_elsewhere = 0.0


def add_time_elsewhere(cpu: float) -> None:
    """Add processor time that another process spent on the work of this one, s."""
    global _elsewhere  # noqa: PLW0603 - as the time of this process, of which it is a part
    _elsewhere += cpu


def processor_time() -> float:
    """Return the processor time of this process and of those that work for it, s."""
    return time.process_time() + _elsewhere


@dataclass(frozen=True, slots=True)
class Expected:
    """What a task is expected to take.

    Parameters
    ----------
    group : str
    effort : float
        Processor time on a usual machine, s.
    alone : bool
        Whether nothing runs beside it.
    """

    group: str
    effort: float
    alone: bool = False


@dataclass(slots=True)
class _Group:
    """Tasks of a group that are done: their number, their efforts and what they took, s."""

    count: int = 0
    effort: float = 0.0
    cpu: float = 0.0

    def factor(self, before: float) -> float:
        """Return seconds taken for each of effort; with few tasks done, near the one before."""
        if not (self.effort > 0.0 and self.cpu > 0.0):
            return before
        share = 1.0 / (1.0 + self.count)
        return float(before**share * (self.cpu / self.effort) ** (1.0 - share))


class Estimate:
    """Follows tasks and says how long those that are left will take.

    Parameters
    ----------
    cores : int
        Tasks that run side by side.
    load : float
        Time by the clock for each second of processor, until tasks tell.
    speeds : mapping of str to float, optional
        Factors of groups from an earlier run.
    """

    def __init__(
        self, cores: int = 1, load: float = 1.0, speeds: Mapping[str, float] | None = None
    ) -> None:
        self.cores = cores
        self._load = load
        self._speeds = dict(speeds or {})
        self._left: dict[Hashable, Expected] = {}
        self._efforts: defaultdict[tuple[str, bool], float] = defaultdict(float)
        self._groups: defaultdict[str, _Group] = defaultdict(_Group)
        self._count, self._cpu, self._wall = 0, 0.0, 0.0

    def expect(self, tasks: Mapping[Any, Expected]) -> None:
        """Set the tasks that are left, in place of those that were."""
        self._left = dict(tasks)
        self._efforts.clear()
        for task in self._left.values():
            self._efforts[task.group, task.alone] += task.effort

    def finish(self, task: Hashable, taken: Taken | None = None) -> None:
        """Take a task off those left; without what it took, nothing is learnt of it."""
        expected = self._left.pop(task, None)
        if expected is None:
            return
        self._efforts[expected.group, expected.alone] -= expected.effort
        if taken is None:
            return
        group = self._groups[expected.group]
        group.count += 1
        group.effort += expected.effort
        group.cpu += taken.cpu
        self._count += 1
        self._cpu += taken.cpu
        self._wall += max(taken.wall, taken.cpu)

    @property
    def tasks(self) -> int:
        """How many tasks are left."""
        return len(self._left)

    @property
    def seconds(self) -> float:
        """How long the tasks that are left will take by the clock, s."""
        factors = self.speeds()
        every = self._general()
        seconds = {False: 0.0, True: 0.0}
        for (group, alone), effort in self._efforts.items():
            seconds[alone] += max(effort, 0.0) * factors.get(group, every)
        longest = 0.0
        if len(self._left) <= _FEW:
            costs = (t.effort * factors.get(t.group, every) for t in self._left.values())
            longest = max(costs, default=0.0)
        load = _Group(self._count, self._cpu, self._wall).factor(self._load)
        return load * max(seconds[False] / self.cores + seconds[True], longest)

    def speeds(self) -> dict[str, float]:
        """Return the factors of all groups that are known, now or from an earlier run."""
        every = self._general()
        return self._speeds | {
            name: group.factor(self._speeds.get(name, every))
            for name, group in self._groups.items()
        }

    def _general(self) -> float:
        """Return the factor of a group of which nothing is known."""
        logs = [math.log(speed) for speed in self._speeds.values()]
        before = math.exp(sum(logs) / len(logs)) if logs else 1.0
        done = self._groups.values()
        known = _Group(self._count, sum(g.effort for g in done), sum(g.cpu for g in done))
        return known.factor(before)


def current_load(cores: int) -> float:
    """Return the time by the clock for a second of processor, with so many tasks more."""
    return max(1.0, (os.getloadavg()[0] + cores) / (os.cpu_count() or 1))


def side_by_side(executor: object, otherwise: int = 1) -> tuple[int, float]:
    """Return how many tasks an executor runs at once, and the load that they meet.

    Parameters
    ----------
    executor : Executor
    otherwise : int
        The number, if the executor has no `workers` and so runs them here.
    """
    cores = int(getattr(executor, "workers", otherwise))
    return cores, 1.0 if getattr(executor, "remote", False) else current_load(cores)


def read_speeds(folder: Path) -> dict[str, float]:
    """Return the factors that an earlier run with a store found on this processor."""
    with suppress(OSError, ValueError, AttributeError):
        known = json.loads((folder / FILE).read_text(encoding="utf-8"))
        own = known.get(processor(), {})
        return {
            name: speed
            for name, speed in own.items()
            if isinstance(speed, float) and 0.0 < speed < math.inf
        }
    return {}


def write_speeds(folder: Path, speeds: Mapping[str, float]) -> None:
    """Keep the factors of this processor in a store; of two programs the later one counts."""
    others: dict[str, object] = {}
    with suppress(OSError, ValueError, TypeError):
        others = dict(json.loads((folder / FILE).read_text(encoding="utf-8")))
    known = others | {processor(): read_speeds(folder) | dict(speeds)}
    with suppress(OSError):  # it is the worth of an estimate, not of a result
        write_atomically(folder / FILE, json.dumps(known, indent=1, sort_keys=True).encode())


def about(seconds: float) -> str:
    """Return a duration in the words of an estimate: two digits at most."""
    if seconds < 99.5:  # noqa: PLR2004 - of which two digits are left
        return f"{seconds:.2g} s"
    minutes = seconds / 60.0
    if minutes < 99.5:  # noqa: PLR2004
        return f"{minutes:.2g} min"
    return f"{minutes / 60.0:.2g} h"


def announcement(seconds: float, tasks: int, cores: int, unit: str = "run") -> str:
    """Return the line before work begins; nothing if it is short.

    Parameters
    ----------
    seconds : float
    tasks : int
    cores : int
    unit : str
        What one task is.
    """
    if seconds < _SAID:
        return ""
    side = f" on {cores} cores" if cores > 1 else ""
    return f"about {about(seconds)} for {tasks} {unit}{'s' * (tasks != 1)}{side}"


def account(taken: float, estimated: float) -> str:
    """Return the line after work; nothing if it was short and expected to be."""
    if max(taken, estimated) < _SAID:
        return ""
    return f"took {about(taken)}, estimated {about(estimated)}"
