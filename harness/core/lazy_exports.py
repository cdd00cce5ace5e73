"""Public names of a package, each imported when it is first asked for.

The program must handle signals before anything heavy is imported, and `rockingcan --help` needs no
engine: so the packages with a public interface state their names and import nothing themselves.
"""

import sys
from collections.abc import Callable, Mapping
from importlib import import_module


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
        value: object = getattr(import_module(module), inner or name)
        setattr(sys.modules[package], name, value)
        return value

    def names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *places})

    return get, names
