"""The contract of an engine's adapter, as a suite that anyone can run on their own engine."""

from harness.engines.conformance.suite import CHECKS, conform
from harness.engines.conformance.verdict import Check, Result, Verdict

__all__ = ["CHECKS", "Check", "Result", "Verdict", "conform"]
