"""What an engine adds to a can of its own accord, measured: one probe for each effect."""

from harness.engines.probes.evidence import Evidence, Finding, Measurement, Trace
from harness.engines.probes.survey import PROBES, Probe, measure, opens_worlds

__all__ = [
    "PROBES",
    "Evidence",
    "Finding",
    "Measurement",
    "Probe",
    "Trace",
    "measure",
    "opens_worlds",
]
