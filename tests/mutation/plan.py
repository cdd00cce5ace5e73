"""Which modules are mutated, and which tests are asked about each."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

_METRICS = "tests/harness/metrics"
_GATE = "tests/harness/gate"
_QUALITY = (f"{_METRICS}/test_energy_and_contact.py", f"{_METRICS}/test_energy_of_effects.py")
_LADDER = (f"{_METRICS}/test_order.py", f"{_METRICS}/test_plateau_and_front.py")
_LIMITS = (f"{_METRICS}/test_limits.py",)
_JUDGED = (f"{_GATE}/test_limits.py", f"{_GATE}/test_comparison.py")

TESTS: dict[str, tuple[str, ...]] = {
    "harness/engines/stepping/schedule.py": (
        "tests/harness/engines/test_schedule_limits.py",
        "tests/harness/engines/test_schedule.py",
    ),
    "harness/metrics/energy.py": _QUALITY,
    "harness/metrics/contact.py": (*_LIMITS, *_QUALITY),
    "harness/metrics/error.py": (*_LIMITS, f"{_METRICS}/test_error.py"),
    "harness/metrics/bounces.py": (*_LIMITS, f"{_METRICS}/test_features.py"),
    "harness/metrics/motion.py": (
        *_QUALITY,
        f"{_METRICS}/test_features.py",
        f"{_METRICS}/test_error.py",
    ),
    "harness/metrics/convergence.py": (*_LIMITS, *_LADDER),
    "harness/gate/baseline.py": (f"{_GATE}/test_baseline.py", f"{_GATE}/test_limits.py"),
    "harness/gate/comparison.py": (*_JUDGED, f"{_GATE}/test_words.py"),
    "harness/gate/spread.py": (f"{_GATE}/test_limits.py", f"{_GATE}/test_ensemble.py"),
    "harness/gate/stored_scores.py": (f"{_GATE}/test_limits.py", f"{_GATE}/test_owed.py"),
    "harness/gate/scores.py": (*_JUDGED, f"{_GATE}/test_ensemble.py", f"{_GATE}/test_owed.py"),
    "harness/gate/report.py": (f"{_GATE}/test_limits.py", f"{_GATE}/test_words.py"),
    "reference/integrable/turning_points.py": (
        "tests/reference/test_turning_points.py",
        "tests/reference/test_exact.py",
    ),
    "reference/integrable/brackets.py": ("tests/reference/test_turning_points.py",),
}
"""Those that are quickest to fail first; whole runs, of a minute and more, are left out."""


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
    """Yield every module that is mutated."""
    for path, tests in TESTS.items():
        yield Target(path=Path(path), tests=tests)
