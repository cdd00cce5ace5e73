"""The checks, a file for each part of the paper; reading them registers them."""

from harness.studies.audit.checks import (  # noqa: F401 - read for what they register
    kinematics,
    equations_of_motion,
    equilibria,
    steady_orbits,
    second_order,
    frobenius,
    constants,
    reduced,
    outer,
    inner,
    numbers,
    phenomena,
    frictionless,
    hamiltonian,
)
