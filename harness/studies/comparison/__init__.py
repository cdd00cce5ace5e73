"""The comparison study: every engine on every scene, as it ships and as well as it can be run."""

from harness.studies.comparison.design import SUITES, design
from harness.studies.comparison.reading import read
from harness.studies.comparison.results import results
from harness.studies.comparison.unsupported import Unsupported, parted

__all__ = ["SUITES", "Unsupported", "design", "parted", "read", "results"]
