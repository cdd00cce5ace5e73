"""Which modules are mutated, and which tests are asked about each."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

_METRICS = ("tests/harness/metrics",)
_SCHEDULE = ("tests/harness/engines/test_schedule.py",)
_GATE = (
    "tests/harness/gate",
    # whole runs of engines, a minute and more; what they rest on is asked of the others
    "--ignore=tests/harness/gate/test_commands.py",
    "--ignore=tests/harness/gate/test_runs.py",
)
_TURNING = ("tests/reference/test_exact.py", "tests/reference/test_constants_of_motion.py")


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
    """Yield every module that is mutated; called at the root of the repository."""
    for folder, tests in (("harness/metrics", _METRICS), ("harness/gate", _GATE)):
        for path in sorted(Path(folder).glob("*.py")):
            if path.name != "__init__.py":
                yield Target(path=path, tests=tests)
    yield Target(path=Path("harness/engines/schedule.py"), tests=_SCHEDULE)
    yield Target(path=Path("reference/turning_points.py"), tests=_TURNING)
