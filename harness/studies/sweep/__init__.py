"""What a sweep shows: counts, extremes, and a curve or a map."""

from harness.studies.sweep.reading import Overview, artefacts, overview

__all__ = ["Overview", "artefacts", "overview"]
