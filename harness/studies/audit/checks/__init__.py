"""The checks, a file for each part of the paper; reading them registers them."""

from harness.studies.audit.checks import (  # noqa: F401 - read for what they register
    agreement,
    constants,
    equations_of_motion,
    equilibria,
    friction,
    frictionless,
    frobenius,
    hamiltonian,
    inner,
    integrals,
    kinematics,
    matching,
    numbers,
    outer,
    phenomena,
    reduced,
    second_order,
    steady_orbits,
)
