"""Tries mutants, each in a process of its own that is forked after the costly imports.

The mutant is never written to the disk: the process imports it from memory, and whatever becomes of
that process, the checkout stays as it is. Only the modules that depend on the mutant are imported
again; that and the frozen garbage of the parent take a trial from 1.1 s to 0.4 s.
"""

import ast
import gc
import importlib
import importlib.abc
import importlib.machinery
import importlib.util
import os
import re
import resource
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest
from hypothesis import Phase, settings

from tests.mutation.plan import Target

OWN = ("harness", "models", "reference")
"""Packages whose modules see the mutant, or import one that does."""

_PLACE = re.compile(r"\w+(\.\w+)+(:\w+)?")
"""How a package that imports lazily names the place of an object."""

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

_FLAGS = (
    "-xq",
    "--assert=plain",  # rewriting assertions only makes a failure more readable
    "-pno:cacheprovider",
    "-p_hypothesis_pytestplugin",
    f"--hypothesis-profile={_PROFILE}",
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
        assert spec is not None
        spec.has_location = True
        return spec

    def get_source(self, fullname: str) -> str:
        del fullname
        return self.source

    def exec_module(self, module: ModuleType) -> None:
        exec(compile(self.source, self.path, "exec"), module.__dict__)  # noqa: S102


def warm(imported: Sequence[str]) -> None:
    """Import what tests need, so that a fork begins warm."""
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    for name in imported:
        importlib.import_module(name)
    gc.freeze()  # pytest collects garbage several times, and would look at all of this


@cache
def _named_in(file: str) -> frozenset[str]:
    """Return the modules, and what is in them, that a module imports at once or lazily."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(Path(file).read_text(encoding="utf-8"))):
        match node:
            case ast.Import(names=names):
                found.update(one.name for one in names)
            case ast.ImportFrom(module=str(module), names=names):
                found.update((module, *(f"{module}.{one.name}" for one in names)))
            case ast.Constant(value=str(text)) if _PLACE.fullmatch(text):
                found.add(text.partition(":")[0])
    return frozenset(found)


@cache
def dependents(module: str) -> frozenset[str]:
    """Return a module and all that were imported and depend on it, their packages among them."""
    known = {
        name: str(one.__file__)
        for name, one in sys.modules.items()
        if name.split(".")[0] in OWN and getattr(one, "__file__", None)
    }
    stale, before = {module}, 0
    while len(stale) > before:
        before = len(stale)
        whole = tuple(f"{name}." for name in stale if not _lazy(name))
        stale |= {
            name
            for name, file in known.items()
            if not stale.isdisjoint(_named_in(file)) or name.startswith(whole)
        }
    return frozenset(stale.intersection(known))


def _lazy(name: str) -> bool:
    """Whether a package imports its public names when they are first asked for."""
    own = vars(sys.modules[name]) if name in sys.modules else {}
    return "__path__" in own and "__getattr__" in own


def _forget(modules: frozenset[str]) -> None:
    """Forget modules, so that they are imported again."""
    for name in modules:
        if _lazy(name):  # what is in it stays, the names that it has looked up do not
            package = vars(sys.modules[name])
            for public in package["__all__"]:
                package.pop(public, None)
            continue
        parent, _, leaf = name.rpartition(".")
        if parent:
            vars(sys.modules[parent]).pop(leaf, None)
    for name in modules:
        if not _lazy(name):
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
    dependents(target.module)  # kept for all trials of the module
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
        _forget(dependents(target.module))
        if source is not None:
            sys.meta_path.insert(0, _FromMemory(target.module, str(target.path), source))
        code = int(pytest.main([*_FLAGS, *target.tests]))
    finally:
        os._exit(code)
