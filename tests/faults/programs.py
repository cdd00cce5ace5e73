"""The program on trial: a short suite of cases, run as any command runs them.

Started with one argument, an `Order` as JSON; prints the outcomes as JSON.

Engines that fail in the ways in which engines do. Each is registered for a trial alone.

Processes of a session, as the system lists them: none may outlive its program.
"""

import ctypes
import itertools
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from harness.api import stepping_engines
from harness.core.case import Case
from harness.core.engine_packages import ENGINE_ENTRY_POINTS
from harness.core.errors import HarnessError
from harness.core.simulation import Simulation
from harness.engines.base import Capabilities, Setting
from harness.engines.registry import engine
from harness.evaluation.run_cases import run_cases
from harness.execution.cache import CacheFolder
from harness.execution.isolated_pool import local_executor
from harness.execution.limits import Limits
from harness.execution.signals import Interrupted, handle_signals
from models.catalogue import load

ENGINES = stepping_engines(None)
"""Engines that do what they should."""

_BLOCK = 2**24
"""Bytes of a bite, each of which is written to: memory that is only reserved is not used."""


def _never(case: Case) -> Simulation | None:
    """Return nothing, whatever the case."""
    del case
    return None


class _Reference:
    """The reference under another name: what a faulty engine is before it fails."""

    name = "sound"
    version = "1"
    settings: tuple[Setting, ...] = ()
    capabilities = Capabilities(honours=frozenset(), imposes={})

    def timestep(self, case: Case) -> float | None:
        """Return the timestep of a case, as it is; the reference has none."""
        return case.timestep

    def simulate(self, case: Case) -> Simulation:
        """Run a case."""
        whole = engine("reference").simulate(replace(case, engine="reference", timestep=None))
        return replace(whole, case=case, model=self.name)


class Crashing(_Reference):
    """Reads from where nothing is."""

    name = "crashing"

    def simulate(self, case: Case) -> Simulation:
        """Die of a segmentation fault."""
        ctypes.string_at(0)
        return super().simulate(case)


class Hanging(_Reference):
    """Never returns, and never lets go of the interpreter for long."""

    name = "hanging"

    def simulate(self, case: Case) -> Simulation:
        """Count for ever."""
        return next(whole for _ in itertools.count() if (whole := _never(case)) is not None)


class Hungry(_Reference):
    """Allocates without end."""

    name = "hungry"

    def simulate(self, case: Case) -> Simulation:
        """Take one block after the other."""
        blocks = [b"\1" * _BLOCK for _ in itertools.count()]
        raise MemoryError(f"{len(blocks)} blocks for {case.label()}")


class Garbling(_Reference):
    """Returns what are no numbers."""

    name = "garbling"

    def simulate(self, case: Case) -> Simulation:
        """Spoil the motion from the second sample on."""
        whole = super().simulate(case)
        if whole.trajectory is None:
            return whole
        position = np.array(whole.trajectory.position)
        position[1:] = np.nan
        return replace(whole, trajectory=replace(whole.trajectory, position=position))


FAULTY: dict[str, type[_Reference]] = {
    kind.name: kind for kind in (Crashing, Hanging, Hungry, Garbling)
}
"""By the names under which they are registered."""


Program = subprocess.Popen[str]

_begun: list[subprocess.Popen[str]] = []

_PATIENCE = 5.0
"""s in which processes that were told to end are gone, on a machine that is busy."""

_DEAD = frozenset("ZX")


def begin(program: str, words: Sequence[str], folder: Path, paths: Sequence[str]) -> Program:
    """Start a program of Python as the leader of a process group of its own.

    Parameters
    ----------
    program : str
    words : sequence of str
        Its arguments.
    folder : Path
        Where it runs.
    paths : sequence of str
        Where it looks for packages first; then where this program does.
    """
    found = [*paths, *(path for path in sys.path if path)]
    process = subprocess.Popen(  # noqa: S603 - our own program
        [sys.executable, "-c", program, *words],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(found)},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    _begun.append(process)
    return process


def end_all() -> None:
    """Kill what was begun and still runs, with all its processes: a trial was interrupted."""
    for process in _begun:
        if process.poll() is None:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
    _begun.clear()


def living(group: int) -> list[int]:
    """Return the processes of a session that run, from Linux's list of them.

    A program that `begin` started leads a group and a session; workers leave the group.
    """
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            # after the name, which may hold anything: state, parent, group, session
            words = (place / "stat").read_text(encoding="utf-8").rpartition(")")[2].split()
            if int(words[3]) == group and words[0] not in _DEAD:
                found.append(int(place.name))
    return found


def resident(group: int) -> int:
    """Return the bytes that the processes of a group hold in memory, shared ones each time.

    A child with exactly its parent's sizes is between fork and exec: its memory is its parent's.
    """
    sizes, parents = {}, {}
    for process in living(group):
        place = Path("/proc", str(process))
        with suppress(OSError):  # it has gone meanwhile
            sizes[process] = (place / "statm").read_text(encoding="utf-8")
            words = (place / "stat").read_text(encoding="utf-8").rpartition(")")[2].split()
            parents[process] = int(words[1])
    own = [s for process, s in sizes.items() if sizes.get(parents.get(process, 0)) != s]
    return sum(int(size.split()[1]) for size in own) * os.sysconf("SC_PAGE_SIZE")


def left_behind(group: int) -> int:
    """Return how many processes of a group still run some seconds after their program has ended."""
    until = time.monotonic() + _PATIENCE
    while (left := living(group)) and time.monotonic() < until:
        time.sleep(0.05)
    for process in left:
        with suppress(ProcessLookupError):
            os.kill(process, signal.SIGKILL)
    return len(left)


def killed_after(process: subprocess.Popen[str], seconds: float) -> bool:
    """Kill a program and all its processes after so many seconds; return False if it had ended."""
    try:
        process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        for each in (process.pid, *living(process.pid)):  # workers lead groups of their own
            with suppress(ProcessLookupError):
                os.kill(each, signal.SIGKILL)
        process.communicate()
        return True
    return False


_WRONG = 2

_PROGRAM = f"from {__name__} import main; main()"


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramRun:
    """What the program is to do.

    Parameters
    ----------
    store : str
        Folder.
    cases : sequence of (scene, engine, profile, timestep)
    jobs : int
    seconds, memory : float
        Limits of a case.
    """

    store: str
    cases: Sequence[tuple[str, str, str, float | None]]
    jobs: int = 2
    seconds: float = 60.0
    memory: float = 4.0 * 2**30


def started(order: ProgramRun, entries: Path | None = None) -> Program:
    """Start the program as the leader of a process group of its own.

    Parameters
    ----------
    order : Order
    entries : Path, optional
        Folder in which engines are registered that the program is to find.
    """
    paths = [] if entries is None else [str(entries)]
    return begin(_PROGRAM, [json.dumps(asdict(order))], Path.cwd(), paths)


def register(folder: Path) -> Path:
    """Register the faulty engines in a folder, as an installed package would; return the folder."""
    metadata = folder / "faulty_engines-1.dist-info"
    metadata.mkdir(parents=True, exist_ok=True)
    lines = [
        f"[{ENGINE_ENTRY_POINTS}]",
        *(f"{n} = {k.__module__}:{k.__name__}" for n, k in FAULTY.items()),
        "",
    ]
    (metadata / "entry_points.txt").write_text("\n".join(lines), encoding="utf-8")
    told = "Metadata-Version: 2.1\nName: faulty-engines\nVersion: 1\n"
    (metadata / "METADATA").write_text(told, encoding="utf-8")
    return folder


def cases_of(order: ProgramRun) -> list[Case]:
    """Return the cases of an order."""
    return [
        Case(scene=load(scene), engine=engine, profile=profile, timestep=timestep)
        for scene, engine, profile, timestep in order.cases
    ]


def main() -> None:
    """Run the cases of the order that is given, print what came of each, leave with a code."""
    order = ProgramRun(**json.loads(sys.argv[1]))
    handle_signals()
    limits = Limits(seconds=order.seconds, memory=order.memory)
    try:
        with local_executor(order.jobs, spawned=True, limits=limits) as executor:
            done = run_cases(cases_of(order), executor, store=CacheFolder(folder=Path(order.store)))
    except (Interrupted, HarnessError) as error:
        told = [str(error), *getattr(error, "__notes__", ())]
        sys.stderr.write(". ".join(told) + "\n")
        sys.exit(error.exit_code if isinstance(error, Interrupted) else _WRONG)
    outcomes = [
        [e.simulation.case.engine, e.simulation.outcome.name, e.simulation.note] for e in done
    ]
    sys.stdout.write(json.dumps(outcomes) + "\n")
