"""How long the program takes to start, beside what it stands on."""

import os
import resource
import subprocess
import sys
from collections.abc import Iterator, Sequence

from tests.benchmarks.clock import Ratio

_ROUNDS = 7
_NUMPY = (sys.executable, "-c", "import numpy")
_COMMANDS: tuple[tuple[tuple[str, ...], float | None], ...] = (
    (("--help",), 4.0),
    (("--version",), 4.0),
    (("scenes",), 4.0),
    (("reference", "no-such-scene"), 4.0),
    (("reference", "gentle-rock"), None),
    (("run", "gentle-rock", "--engine", "mujoco", "--timestep", "1e-3"), None),
)
"""Commands, and the bound on their ratio to an import of numpy."""


def start_up_ratios() -> Iterator[Ratio]:
    """Measure the start of commands against the import of numpy."""
    for words, bound in _COMMANDS:
        program = (sys.executable, "-m", "harness", *words)
        pairs = [(_processor_time(program), _processor_time(_NUMPY)) for _ in range(_ROUNDS)]
        first, second = (min(taken) for taken in zip(*pairs, strict=True))
        yield Ratio(
            what=f"`rockingcan {' '.join(words)}` against `python -c 'import numpy'`",
            ratio=first / second,
            claim="" if bound is None else f"at most {bound:g}",
            holds=bound is None or first / second <= bound,
            first_s=first,
            second_s=second,
            note=f"each in a process of its own; shortest of {_ROUNDS}",
        )


def _processor_time(program: Sequence[str]) -> float:
    """Return the processor time of a program from its start to its end, s."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(  # noqa: S603 - our own program
        program,
        env=os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        check=False,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
