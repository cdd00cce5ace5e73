"""Measurement of the effects that an engine adds to every can: one probe for each effect."""

from harness.engines.probes import contact, drop, flight, heading, impact  # noqa: F401 - the probes, in the order of report
from harness.engines.probes.survey import PROBES, Measurement, ProbeFinding, measure

__all__ = ["PROBES", "Measurement", "ProbeFinding", "measure"]
