"""The capabilities study: what each engine adds to a can of its own accord, measured."""

from harness.studies.capabilities.design import PROFILES, design
from harness.studies.capabilities.reading import read

__all__ = ["PROFILES", "design", "read"]
