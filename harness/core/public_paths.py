"""Public names of a package, imported when first asked for, and names of the previous release.

The program must handle signals before anything heavy is imported, and `rockingcan --help` needs no
engine: so a package with a public interface states its names and imports nothing itself.

Import paths of the previous release work for one release more, with a warning. An adapter that was
written against them goes on working; `harness.engines` has all that it needs.
"""

import importlib
import sys
import warnings
from collections.abc import Callable, Mapping, Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import MappingProxyType, ModuleType

MOVED = MappingProxyType(
    {
        "harness.artefact": "harness.core.report_model",
        "harness.bounce": "harness.core.bounce",
        "harness.case": "harness.core.case",
        "harness.engines.chunk": "harness.engines.stepping.recording",
        "harness.engines.horizon": "harness.engines.stepping.horizon",
        "harness.engines.schedule": "harness.engines.stepping.schedule",
        "harness.engines.settling": "harness.engines.stepping.settling",
        "harness.engines.variants": "harness.engines.base",
        "harness.engines.walking": "harness.engines.stepping.generic_stepping",
        "harness.errors": "harness.core.errors",
        "harness.face": "harness.api",
        "harness.runner": "harness.evaluation.evaluate",
        "harness.simulation": "harness.core.simulation",
        "harness.trajectory": "harness.core.trajectory",
    }
)
"""Modules that an adapter could import, and what they have become."""


class RenamedValueWarning(FutureWarning):
    """A value of an option is given by its name of the previous release.

    It concerns whoever typed the value, so that the command line prints it; a `DeprecationWarning`
    concerns the author of an adapter, and Python shows it in tests only.
    """


def warn_renamed(message: str, category: type[Warning] = DeprecationWarning) -> None:
    """Warn of a name of the previous release, at the line that called the caller."""
    warnings.warn(message, category, stacklevel=3)


class _MovedModule(Loader):
    """Loads a module under its old name: the same module object as under its new one."""

    def __init__(self, module: ModuleType) -> None:
        self._module, self._spec = module, module.__spec__

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Return the module that is imported already."""
        del spec
        return self._module

    def exec_module(self, module: ModuleType) -> None:
        """Leave the module as it is: it has been run, and keeps its own name."""
        module.__spec__ = self._spec


class _MovedFinder(MetaPathFinder):
    """Finds the modules of `MOVED` under their old names, with a `DeprecationWarning`."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return how an old name is loaded, or None for any other name."""
        del path, target
        if fullname not in MOVED:
            return None
        new = MOVED[fullname]
        public = "harness.engines" if fullname.startswith("harness.engines") else new
        warn_renamed(
            f"'{fullname}' is now '{new}'; adapters import from 'harness.engines' "
            f"('{public}' stays), and the old path goes with the next release"
        )
        return ModuleSpec(fullname, _MovedModule(importlib.import_module(new)))


def install() -> None:
    """Have old import paths work, once."""
    if not any(isinstance(finder, _MovedFinder) for finder in sys.meta_path):
        sys.meta_path.append(_MovedFinder())


def lazy_exports(
    package: str, places: Mapping[str, str]
) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """Return `__getattr__` and `__dir__` of a package.

    Parameters
    ----------
    package : str
        Its `__name__`.
    places : mapping of str to str
        By public name, the module that defines it, or "module:name" where its name is another.
    """

    def get(name: str) -> object:
        if name not in places:
            raise AttributeError(f"module '{package}' has no attribute '{name}'")
        module, _, inner = places[name].partition(":")
        value: object = getattr(importlib.import_module(module), inner or name)
        setattr(sys.modules[package], name, value)
        return value

    def names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *places})

    return get, names
