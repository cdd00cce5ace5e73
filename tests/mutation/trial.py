"""Tries mutants, each in a process of its own that is forked after the costly imports.

The mutant is never written to the disk: the process imports it from memory, and whatever becomes of
that process, the checkout stays as it is.
"""

import importlib
import importlib.abc
import importlib.machinery
import importlib.util
import os
import resource
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from types import ModuleType

import pytest
from hypothesis import Phase, settings

from tests.mutation.plan import Target

OWN = ("harness", "models", "reference")
"""Packages that each process imports anew, so that all of them see the mutant."""

_MEMORY = 4 << 30
"""Bytes that a process may have: a mutant that allocates without end is as good as one that hangs.
"""


_PROFILE = "mutation"
settings.register_profile(
    _PROFILE,
    derandomize=True,
    deadline=None,
    max_examples=50,
    phases=(Phase.explicit, Phase.generate),  # any example that fails will do, the smallest costs
)


class Verdict(Enum):
    """What the tests say of a mutant."""

    SURVIVED = "survived"
    KILLED = "killed"
    HUNG = "hung"


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """A verdict and what it cost in processor time, s."""

    verdict: Verdict
    seconds: float


class _FromMemory(importlib.abc.MetaPathFinder, importlib.abc.InspectLoader):
    """Finds one module in memory."""

    def __init__(self, name: str, path: str, source: str) -> None:
        self.name, self.path, self.source = name, path, source

    def find_spec(
        self, fullname: str, path: object = None, target: object = None
    ) -> importlib.machinery.ModuleSpec | None:
        del path, target
        if fullname != self.name:
            return None
        spec = importlib.util.spec_from_loader(fullname, self, origin=self.path)
        spec.has_location = True
        return spec

    def get_source(self, fullname: str) -> str:
        del fullname
        return self.source

    def exec_module(self, module: ModuleType) -> None:
        exec(compile(self.source, self.path, "exec"), module.__dict__)  # noqa: S102


def warm(imported: Sequence[str]) -> None:
    """Import what tests need and forget this project's part of it, so that a fork begins warm."""
    for name in imported:
        importlib.import_module(name)
    for name in [name for name in sys.modules if name.split(".")[0] in OWN]:
        del sys.modules[name]


def tried(target: Target, source: str | None, allowed: float) -> Trial:
    """Run a target's tests against a mutated source, or against the module itself.

    Parameters
    ----------
    target : Target
    source : str or None
        None for the module as it is.
    allowed : float
        Processor time after which a mutant is taken to hang, s.

    Raises
    ------
    RuntimeError
        If the tests did not run at all.
    """
    child = os.fork()
    if child == 0:
        _child(target, source, allowed)
    _, status, used = os.wait4(child, 0)
    seconds = used.ru_utime + used.ru_stime
    if os.WIFSIGNALED(status):
        return Trial(verdict=Verdict.HUNG, seconds=seconds)
    code = os.waitstatus_to_exitcode(status)
    if code in {pytest.ExitCode.NO_TESTS_COLLECTED, pytest.ExitCode.USAGE_ERROR} and source is None:
        raise RuntimeError(f"no tests of {target.module} ran: {' '.join(target.tests)}")
    return Trial(verdict=Verdict.KILLED if code else Verdict.SURVIVED, seconds=seconds)


def _child(target: Target, source: str | None, allowed: float) -> None:
    """Run the tests in the forked process, and leave it with the code of pytest."""
    code = 70  # what a fault of this function itself leaves with
    try:
        resource.setrlimit(resource.RLIMIT_CPU, (int(allowed) + 1, int(allowed) + 2))
        resource.setrlimit(resource.RLIMIT_DATA, (_MEMORY, _MEMORY))
        sink = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(sink, stream)
        if source is not None:
            sys.meta_path.insert(0, _FromMemory(target.module, str(target.path), source))
        # assertions as they stand: rewriting them only makes a failure more readable
        flags = ("-xq", "--assert=plain", "-pno:cacheprovider", f"--hypothesis-profile={_PROFILE}")
        code = int(pytest.main([*flags, *target.tests]))
    finally:
        os._exit(code)
