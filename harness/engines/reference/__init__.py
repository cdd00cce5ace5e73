"""The reference as an engine: the exact equations, in the harness's units and frames.

The one package of the harness that imports `reference`. A reference model moves a can like any
engine does, so it can be run, timed and compared like one; and as the truth it can be asked for its
state at any instant, so that an engine is compared on its own time grid.
"""

from harness.engines.reference.assumption_checks import (
    PARTED,
    Divergence,
    Guard,
    check_assumptions,
    divergence_of,
    findings,
    may_be_chaotic,
)
from harness.engines.reference.engine import ReferenceEngine
from harness.engines.reference.to_reference_problem import carried, refusal
from harness.engines.reference.truth import (
    SETTINGS,
    VARIANTS,
    WITHOUT_LOCUS,
    Phase,
    Truth,
    apart,
    beside,
    cancelled,
    sample_truth,
    solve_case,
    truth,
)
from reference import ENDING, Agreement, Finding

__all__ = [
    "ENDING",
    "PARTED",
    "SETTINGS",
    "VARIANTS",
    "WITHOUT_LOCUS",
    "Agreement",
    "Divergence",
    "Finding",
    "Guard",
    "Phase",
    "ReferenceEngine",
    "Truth",
    "apart",
    "beside",
    "cancelled",
    "carried",
    "check_assumptions",
    "divergence_of",
    "findings",
    "may_be_chaotic",
    "refusal",
    "sample_truth",
    "solve_case",
    "truth",
]
