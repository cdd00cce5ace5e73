"""The reference as an engine: the exact equations, in the harness's units and frames.

The one package of the harness that imports `reference`. A reference model moves a can like any
engine does, so it can be run, timed and compared like one; and as the truth it can be asked for its
state at any instant, so that an engine is compared on its own time grid.
"""

from harness.engines.description import Description, Method
from harness.engines.reference.engine import ReferenceEngine
from reference import (
    ENDING,
    PARTED,
    RENAMED_METHODS,
    Agreement,
    Finding,
    Impact,
    Kind,
    path_taken,
    renamed_method,
)

__all__ = [
    "DESCRIPTION",
    "ENDING",
    "PARTED",
    "RENAMED_METHODS",
    "Agreement",
    "Finding",
    "Impact",
    "Kind",
    "ReferenceEngine",
    "path_taken",
    "renamed_method",
]

DESCRIPTION = Description(label="exact motion", method=Method.ERROR_CONTROL)
