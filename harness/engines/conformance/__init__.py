"""The contract of an engine's adapter, as a suite that anyone can run on their own engine."""

from harness.engines.conformance import answers, motion, scene_effects  # noqa: F401 - the clauses
from harness.engines.conformance.suite import CLAUSES, ClauseResult, ClauseStatus, conform

__all__ = ["CLAUSES", "ClauseResult", "ClauseStatus", "conform"]
