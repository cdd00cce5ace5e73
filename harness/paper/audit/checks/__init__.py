"""The checks, a file for each part of the paper; the import registers them for `audit`."""

from harness.paper.audit.checks import (  # noqa: F401 - each registers its checks
    equations_of_motion,
    exact_solution,
    friction,
    frictionless,
    frobenius,
    hamiltonian,
    inner,
    kinematics,
    locus,
    matching,
    momenta,
    numbers,
    outer,
    panels,
    reduced,
    references,
    steady_motions,
    steady_paths,
    steady_sets,
)
from harness.paper.audit.evidence import audit

__all__ = ["audit"]
