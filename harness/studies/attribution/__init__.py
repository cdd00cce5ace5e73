"""The attribution study: which of an engine's gaps causes which part of its discrepancy."""

from harness.studies.attribution.path import Path, design, path
from harness.studies.attribution.reading import Attribution, attribution, read

__all__ = ["Attribution", "Path", "attribution", "design", "path", "read"]
