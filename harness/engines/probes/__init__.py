"""What an engine adds to a can of its own accord, measured: one probe for each effect."""

from harness.engines.probes.fixture import Evidence, Measurement, ProbeFinding, Trace
from harness.engines.probes.survey import PROBES, Probe, measure, opens_worlds

__all__ = [
    "PROBES",
    "Evidence",
    "Measurement",
    "Probe",
    "ProbeFinding",
    "Trace",
    "measure",
    "opens_worlds",
]
