"""Sweeps at size: a million releases, the cost of each, and runs in one process and in two."""

import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from threading import Event, Thread

from harness.execution.isolated_pool import SerialExecutor, local_executor
from harness.sweep.axes import read_axis
from harness.sweep.folder import opened
from harness.sweep.plan import SweepPlan, plan_sweep
from harness.sweep.run import run_sweep
from models.catalogue import load
from tests.faults.programs import Program, begin, resident
from tests.faults.trial import Trial

_SECONDS, _MEMORY = 60.0, 500e6
"""Allowed for the largest map, the whole command: s, and bytes of all its processes together."""

_FLAT = 1.25
"""The largest map's cost of a release over that of the second: of the first, starting is a part."""

_EFFICIENCY = 0.85
"""Speed of two processes over twice that of one."""

_PROGRAM = "from harness.cli import main; main()"

_GLANCE = 0.02
"""s between two looks at what a program holds in memory."""

_PATIENCE = 20.0 * _SECONDS


@dataclass(frozen=True, slots=True, kw_only=True)
class Sizes:
    """How much is swept.

    Parameters
    ----------
    maps : tuple of (int, int)
        Releases across and up, ascending. Even one way, so that none is at rest.
    runs : int
        Of an engine.
    telling : bool
        Whether these sizes take so long that their ratios say anything of the program.
    """

    maps: tuple[tuple[int, int], ...] = ((25, 40), (100, 100), (250, 400), (1000, 1000))
    runs: int = 10_000
    telling: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class _Part:
    """What one part of the trial found."""

    words: str
    passed: bool


def sweeps(sizes: Sizes, folder: Path, told: Callable[[str], None]) -> Trial:
    """Sweep releases by the exact bounce and by an engine, and hold time and memory to demands."""
    began = time.monotonic()
    across, up = sizes.maps[-1]
    parts = (
        _whole_command(across, up, folder / "command", told),
        _cost(sizes, folder / "cost", told),
        _scaling(sizes, folder / "scaling", told),
    )
    return Trial(
        name="sweeps",
        done=f"a map of {across * up:,} releases by the exact bounce with the command; maps of "
        f"{', '.join(f'{a * b:,}' for a, b in sizes.maps)} in one thread; {sizes.runs:,} runs of "
        "gentle-rock in MuJoCo at 1e-3 s in one process and in two",
        demanded=f"the command below {_SECONDS:.0f} s and {_MEMORY / 1e6:.0f} MB; a release of the "
        f"largest map at most {_FLAT} times the cost of one of {_count(sizes.maps[1]):,}; "
        f"efficiency of two processes {_EFFICIENCY} or more, and the same files to the byte",
        found=tuple(part.words for part in parts),
        passed=all(part.passed for part in parts),
        seconds=time.monotonic() - began,
    )


def _over(across: int, up: int) -> tuple[str, str]:
    return f"release.psi_dot=-1:1:{across}", f"release.theta_dot=-1:1:{up}"


def _count(shape: tuple[int, int]) -> int:
    return shape[0] * shape[1]


def _whole_command(across: int, up: int, folder: Path, told: Callable[[str], None]) -> _Part:
    """Run the command as a user does, report included; look at its memory all the while."""
    told(f"{across * up:,} releases by the exact bounce")
    folder.mkdir(parents=True)
    over = [word for axis in _over(across, up) for word in ("--over", axis)]
    words = ["sweep", "paper-release", *over, "--jobs", "2", "--out", str(folder / "map")]
    began = time.monotonic()
    process = begin(_PROGRAM, [*words, "--json"], folder, ())
    with _watched(process) as most:
        said, complained = process.communicate(timeout=_PATIENCE)
    seconds = time.monotonic() - began
    whole = process.returncode == 0 and f'"scenes": {across * up}' in said
    return _Part(
        words=f"{across * up:,} releases, the whole command from start to report: {seconds:.1f} s "
        f"on two of {os.cpu_count()} cores; at most {most[0] / 1e6:.0f} MB resident, summed over "
        f"all its processes every {_GLANCE * 1e3:.0f} ms"
        + ("" if whole else f"; code {process.returncode}: {complained.strip()[-200:]}"),
        passed=whole and seconds < _SECONDS and 0 < most[0] < _MEMORY,
    )


@contextmanager
def _watched(process: Program) -> Iterator[list[int]]:
    """Give the most bytes that a program and its processes held, known when the block is left."""
    most, done = [0], Event()

    def look() -> None:
        while not done.wait(_GLANCE):
            most[0] = max(most[0], resident(process.pid))

    watcher = Thread(target=look, daemon=True)
    watcher.start()
    try:
        yield most
    finally:
        done.set()
        watcher.join()


def _cost(sizes: Sizes, folder: Path, told: Callable[[str], None]) -> _Part:
    """Return what a release costs in maps of several sizes: processor time of one thread."""
    warm = plan_sweep(load("paper-release"), [read_axis(text) for text in _over(2, 2)])
    _processor_time(warm, folder / "warm")
    costs = []
    for number, (across, up) in enumerate(sizes.maps):
        told(f"the cost of one of {across * up:,} releases")
        chosen = plan_sweep(load("paper-release"), [read_axis(text) for text in _over(across, up)])
        costs.append(_processor_time(chosen, folder / str(number)) / chosen.rows)
    each = ", ".join(
        f"{1e6 * cost:.1f} us of {_count(shape):,}"
        for cost, shape in zip(costs, sizes.maps, strict=True)
    )
    ratio = costs[-1] / costs[1]
    return _Part(
        words=f"cost of one release, processor time of solving and writing: {each}; the largest "
        f"over {_count(sizes.maps[1]):,}: {ratio:.2f}{_unjudged(sizes)}",
        passed=ratio <= _FLAT or not sizes.telling,
    )


def _processor_time(chosen: SweepPlan, out: Path) -> float:
    """Return the processor time of a sweep in this thread, its start left out, in s."""
    with opened(out, chosen) as folder:
        began = time.thread_time()
        run_sweep(folder, SerialExecutor())
        return time.thread_time() - began


def _scaling(sizes: Sizes, folder: Path, told: Callable[[str], None]) -> _Part:
    """Run an engine in one process and in two, and compare times and files."""
    chosen = plan_sweep(
        load("gentle-rock"),
        [read_axis("release.psi_dot=1.5:2.5")],
        sample="sobol",
        count=sizes.runs,
        engine="mujoco",
        timestep=1e-3,
    )
    seconds, files = [], []
    for jobs in (1, 2):
        told(f"{sizes.runs:,} runs of an engine in {jobs} process{'es' * (jobs > 1)}")
        out = folder / str(jobs)
        began = time.monotonic()
        with opened(out, chosen) as place, local_executor(jobs, spawned=True) as executor:
            run_sweep(place, executor)
        seconds.append(time.monotonic() - began)
        files.append({path.name: path.read_bytes() for path in place.parts.iterdir()})
    efficiency = seconds[0] / (2.0 * seconds[1])
    same = all(one == other for one, other in pairwise(files))
    whole = len(files[0]) == chosen.partitions
    return _Part(
        words=f"{sizes.runs:,} runs: {seconds[0]:.1f} s in one process, {seconds[1]:.1f} s in two, "
        f"their start included; efficiency {efficiency:.2f}{_unjudged(sizes)}; "
        f"{len(files[0])} files, {'the same to the byte' if same else 'which DIFFER'}",
        passed=same and whole and (efficiency >= _EFFICIENCY or not sizes.telling),
    )


def _unjudged(sizes: Sizes) -> str:
    return "" if sizes.telling else " (of so few not judged)"
