"""What an engine adds to a can of its own accord, measured: one probe for each effect."""

from harness.engines.probes.survey import PROBES, Measurement, ProbeFinding, design, measure

__all__ = ["PROBES", "Measurement", "ProbeFinding", "design", "measure"]
