"""How fast it is, measured: each claim a ratio of two timings in one run."""

from harness.benchmark.clock import Ratio
from harness.benchmark.engines import engine_ratios
from harness.benchmark.lean import Lean, lean_ratios
from harness.benchmark.reference import reference_ratios

__all__ = ["Lean", "Ratio", "engine_ratios", "lean_ratios", "reference_ratios"]
