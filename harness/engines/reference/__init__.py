"""The reference as an engine: the exact equations, in the harness's units and frames.

The one package of the harness that imports `reference`. A reference model moves a can like any
engine does, so it can be run, timed and compared like one; and as the truth it can be asked for its
state at any instant, so that an engine is compared on its own time grid.
"""

from harness.engines.reference.engine import ReferenceEngine
from reference import ENDING, PARTED, RENAMED_METHODS, Agreement, Finding, Kind, renamed_method

__all__ = [
    "ENDING",
    "PARTED",
    "RENAMED_METHODS",
    "Agreement",
    "Finding",
    "Kind",
    "ReferenceEngine",
    "renamed_method",
]
