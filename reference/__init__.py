"""The mathematics of the rocking can, dimensionless: the truth with which engines are compared.

`solve` solves a `Problem`. The paper's closed formulas are functions too; the docstring of each, or
of its module, says where the paper is in error.

    steady_rotation                  eq01:equilibrium
    squared_eigenvalue               eq01:eigenvalues
    critical_rolling_rate            where eq01:eigenvalues vanish
    balanced_rotation                eq01:bal_eqm
    circle_radius, rest_rates        below eq01:comcoords and eq01:comrest
    paper_constants                  B_0 and B_{-2} of eq01:psi_orig
    leading_constants                eq01:A_sol, eq01:B_sol
    hypergeometric_pair              eq01:hyper_geom
    matched_of                       eq01:outer_solution to eq01:angle_of_turn
    boundary_rotation                eq01:boundary
    locus_arc                        eq01:contact_pt_inner, eq01:contact_pt_outer
    friction_bound, friction_ratio   eq01:required_friction, eq01:friction_short
    locus_velocity                   eq01:contact_point_velocity
    centre_velocity                  eq01:com_velocity; centre_position is its integral
    leading_turn_without_friction    app01:Phi_reduced_slip
"""

from reference.analysis.agreement import ENDING, Agreement
from reference.analysis.conditioning import neighbours
from reference.analysis.confirmation import differences
from reference.analysis.lyapunov import PARTED, Divergence, divergence
from reference.analysis.validity import Finding, Guard, examine
from reference.asymptotic.expansions import leading_constants, paper_constants
from reference.asymptotic.hypergeometric import hypergeometric_pair
from reference.asymptotic.matched import boundary_rotation, friction_bound, locus_arc, matched_of
from reference.equations.contact_laws import Kind, Phase
from reference.equations.frictionless import leading_turn_without_friction
from reference.equations.reaction_force import (
    centre_position,
    centre_velocity,
    friction_ratio,
    locus_velocity,
)
from reference.equations.steady_motion import (
    balanced_rotation,
    circle_radius,
    critical_rolling_rate,
    rest_rates,
    squared_eigenvalue,
    steady_rotation,
)
from reference.integrable.cycle import PeriodicMotions, exact_bounces
from reference.problem.can import PAPER_CAN, ParameterError, Parameters
from reference.problem.effects import EffectError, Effects, Gravity, Mass
from reference.problem.outcome import Outcome
from reference.problem.problem import Problem, ProblemError
from reference.problem.states import States
from reference.solution import Bounce, Solution
from reference.solve import (
    METHODS,
    MODELS,
    RENAMED_METHODS,
    Choice,
    SolverError,
    carries,
    renamed_method,
    smallest,
    solve,
)

__all__ = [
    "ENDING",
    "METHODS",
    "MODELS",
    "PAPER_CAN",
    "PARTED",
    "RENAMED_METHODS",
    "Agreement",
    "Bounce",
    "Choice",
    "Divergence",
    "EffectError",
    "Effects",
    "Finding",
    "Gravity",
    "Guard",
    "Kind",
    "Mass",
    "Outcome",
    "ParameterError",
    "Parameters",
    "PeriodicMotions",
    "Phase",
    "Problem",
    "ProblemError",
    "Solution",
    "SolverError",
    "States",
    "balanced_rotation",
    "boundary_rotation",
    "carries",
    "centre_position",
    "centre_velocity",
    "circle_radius",
    "critical_rolling_rate",
    "differences",
    "divergence",
    "exact_bounces",
    "examine",
    "friction_bound",
    "friction_ratio",
    "hypergeometric_pair",
    "leading_constants",
    "leading_turn_without_friction",
    "locus_arc",
    "locus_velocity",
    "matched_of",
    "neighbours",
    "paper_constants",
    "renamed_method",
    "rest_rates",
    "smallest",
    "solve",
    "squared_eigenvalue",
    "steady_rotation",
]
