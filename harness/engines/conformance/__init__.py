"""The contract of an engine's adapter, as a suite that anyone can run on their own engine."""

from harness.engines.conformance.fixture import Check, ClauseResult, ClauseStatus
from harness.engines.conformance.suite import CHECKS, conform

__all__ = ["CHECKS", "Check", "ClauseResult", "ClauseStatus", "conform"]
