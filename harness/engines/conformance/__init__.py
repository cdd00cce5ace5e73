"""The contract of an engine's adapter, as a suite that anyone can run on their own engine."""

from harness.engines.conformance.fixture import ClauseResult, ClauseStatus
from harness.engines.conformance.suite import CLAUSES, conform

__all__ = ["CLAUSES", "ClauseResult", "ClauseStatus", "conform"]
