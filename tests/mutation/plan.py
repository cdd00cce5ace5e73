"""Which modules are mutated, and which tests are asked about each.

By packages, so that a module that is added or moved is mutated too: it is asked of the tests in its
package's folder that import it, and of all of them if none does.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

LIMITS = "limits"
"""In the name of a file of tests at the boundaries of constants: they are quick, and kill most."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Package:
    """Modules, and where their tests are.

    Parameters
    ----------
    modules : str
        Glob from the root of the checkout.
    tests : str
        Folder.
    left_out : tuple of str
        Files of tests that take a minute and more, of whole runs.
    only : tuple of str
        Tests that are asked, if not those that import the module.
    """

    modules: str
    tests: str
    left_out: tuple[str, ...] = ()
    only: tuple[str, ...] = ()


_EXACT = "tests/reference/test_exact.py::test_{}"
_OF_MANY = (
    "releases_that_never_bounce",
    "forty_digits",
    "cost_does_not_grow_with_the_hardness",
    "random_releases_leave_no_nan",
)
"""Tests of whole batches: they look at every turning point and cost less than one motion does."""

PACKAGES = (
    Package(
        modules="harness/engines/stepping/schedule.py",
        tests="tests/harness/engines",
        left_out=("test_looks.py", "test_sampling_interval.py"),
    ),
    Package(modules="harness/metrics/**/*.py", tests="tests/harness/metrics"),
    Package(
        modules="harness/gate/**/*.py",
        tests="tests/harness/gate",
        left_out=("test_commands.py", "test_runs.py"),
    ),
    Package(
        modules="harness/results/**/*.py",
        tests="tests/harness/results",
        left_out=("test_commands.py",),
    ),
    Package(
        modules="reference/integrable/turning_points.py",
        tests="tests/reference",
        only=("tests/reference/test_turning_points.py", *map(_EXACT.format, _OF_MANY)),
    ),
    Package(
        modules="reference/integrable/brackets.py",
        tests="tests/reference",
        only=("tests/reference/test_turning_points.py",),
    ),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """A module and the arguments of pytest that select its tests."""

    path: Path
    tests: tuple[str, ...]

    @property
    def module(self) -> str:
        """Its dotted name."""
        return ".".join(self.path.with_suffix("").parts)


def targets() -> Iterator[Target]:
    """Yield every module that is mutated.

    Raises
    ------
    FileNotFoundError
        If a package has no module.
    """
    for package in PACKAGES:
        paths = [path for path in sorted(Path().glob(package.modules)) if path.stem != "__init__"]
        if not paths:
            raise FileNotFoundError(f"no module is '{package.modules}': name where it is now")
        for path in paths:
            yield Target(path=path, tests=tests_of(path, package))


def tests_of(path: Path, package: Package) -> tuple[str, ...]:
    """Return the files of tests that are asked about a module, the quickest to fail first."""
    if package.only:
        return package.only
    files = [
        one for one in Path(package.tests).glob("test_*.py") if one.name not in package.left_out
    ]
    name = ".".join(path.with_suffix("").parts)
    direct = [one for one in files if f"from {name} import" in one.read_text(encoding="utf-8")]
    asked = sorted(direct or files, key=lambda one: (LIMITS not in one.name, one.name))
    return tuple(map(str, asked))
