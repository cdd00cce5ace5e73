"""Whole jobs from their start to their report: sweeps of a million and more, the quick suite."""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from harness.sweep.plan import COMPILED_FROM
from reference.numerics.compiled import available, path_taken
from tests.benchmarks.clock import Ratio

_FEW, _MANY, _MORE = COMPILED_FROM, 1_000_000, 10_000_000
"""Releases of a sweep that compiles kernels, of one with rows, and of one without."""

_SECONDS, _MEGABYTES = 8.0, 500.0
"""What a sweep with rows is to take on two cores."""

_BILLION, _HOUR = 1e9, 3600.0
"""Releases that a sweep without rows is to solve in an hour, s, by the rate that is measured."""

_STARTS = 3
"""Runs of the few, of which the shortest counts: the first may compile what such sweeps use."""

_QUICK_SUITE = 30.0
"""s of processor."""

_SUITE = ("validate", "--suite", "quick", "--no-store")

_SWEEP = (
    *("sweep", "paper-release", "--over", "release.phi=0.02:0.5", "--over", "release.psi_dot=-2:2"),
    *("--over", "release.theta_dot=-2:2", "--sample", "random"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """What a command took.

    Parameters
    ----------
    wall_s, processor_s : float
        The second of all its processes.
    megabytes : float
        Largest memory of one of its processes.
    """

    wall_s: float
    processor_s: float
    megabytes: float


def whole_job_ratios() -> Iterator[Ratio]:
    """Measure commands, each in a process of its own, into a folder that is thrown away."""
    with tempfile.TemporaryDirectory() as folder:
        # kernels are compiled once for each version of the program, which no row counts
        run((*_SWEEP, "--count", str(_FEW), "--out", "few"), folder)
        yield _with_rows(folder)
        yield _without_rows(folder)
        yield _suite(folder)


def _with_rows(folder: str) -> Ratio:
    """Hold a sweep with rows, from start to report, against its seconds."""
    seconds = _SECONDS * _MANY / 1_000_000
    job = run((*_SWEEP, "--count", str(_MANY), "--out", "rows"), folder)
    return _against(
        f"a sweep of {_MANY:,} releases, start to report", job, job.wall_s, seconds, "wall time"
    )


def _without_rows(folder: str) -> Ratio:
    """Hold a sweep of a billion releases without rows against an hour, by a smaller one.

    What a sweep takes before its first release and after its last it takes once, however large it
    is: as much as one of a few releases. The memory is that of the smaller one: it does not grow.
    """

    def reduced(count: int, name: str) -> Job:
        return run((*_SWEEP, "--count", str(count), "--reduce", "--out", name), folder)

    few = min((reduced(_FEW, f"few-{n}") for n in range(_STARTS)), key=lambda job: job.wall_s)
    job = reduced(_MORE, "more")
    each = (job.wall_s - few.wall_s) / (_MORE - _FEW)
    return _against(
        f"a sweep of {_BILLION:.0e} releases without rows, by the rate of {_MORE:,}",
        job,
        few.wall_s + each * (_BILLION - _FEW),
        _HOUR,
        f"{few.wall_s:.1f} s for {_FEW:,} releases and {job.wall_s:.1f} s for {_MORE:,}",
    )


def _against(what: str, job: Job, taken: float, seconds: float, note: str) -> Ratio:
    """Hold a wall time against a limit, and the memory of a job."""
    # what two cores do in so many seconds is for two cores to show, and for compiled code
    claimed = available() and (os.cpu_count() or 1) > 1
    return Ratio(
        what=f"{what}, against {seconds:,g} s",
        ratio=seconds / taken,
        claim=f"under {seconds:,g} s and {_MEGABYTES:g} MB on two cores" if claimed else "",
        holds=(taken < seconds and job.megabytes < _MEGABYTES) or not claimed,
        first_s=taken,
        second_s=seconds,
        note=f"{note}; {job.processor_s:.1f} s of processor, {job.megabytes:.0f} MB; "
        f"{path_taken(compiled=available())}",
    )


def _suite(folder: str) -> Ratio:
    """Hold the processor time of the quick suite against half a minute."""
    job = run(_SUITE, folder)
    return Ratio(
        what=f"the quick suite against {_QUICK_SUITE:g} s of processor",
        ratio=_QUICK_SUITE / job.processor_s,
        claim=f"under {_QUICK_SUITE:g} s",
        holds=job.processor_s < _QUICK_SUITE,
        first_s=job.processor_s,
        second_s=_QUICK_SUITE,
        note=f"all of its processes; {job.wall_s:.1f} s by the clock",
    )


def run(words: Sequence[str], folder: str) -> Job:
    """Run a command of the program in a folder.

    Raises
    ------
    CalledProcessError
        If it does not end with 0.
    """
    program = [sys.executable, "-m", "harness", *words]
    started = time.perf_counter()
    running = subprocess.Popen(  # noqa: S603 - our own program
        program, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    _, status, usage = os.wait4(running.pid, 0)
    taken = time.perf_counter() - started
    running.returncode = os.waitstatus_to_exitcode(status)
    if running.returncode != 0:
        raise subprocess.CalledProcessError(running.returncode, program)
    return Job(
        wall_s=taken,
        processor_s=usage.ru_utime + usage.ru_stime,
        megabytes=usage.ru_maxrss / 1024.0,
    )
