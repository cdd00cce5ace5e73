from .analysis.agreement import ENDING, Agreement
from .analysis.coming_to_rest import Rest, coming_to_rest, is_regular
from .analysis.conditioning import neighbours
from .analysis.confirmation import differences
from .analysis.lyapunov import PARTED, Divergence, divergence
from .analysis.validity import Finding, FindingKind, Guard, examine
from .asymptotic.expansions import leading_constants, paper_constants
from .asymptotic.hypergeometric import hypergeometric_pair
from .asymptotic.matched import boundary_rotation, friction_bound, locus_arc, matched_of
from .equations.contact_laws import Impact, Kind, Phase
from .equations.frictionless import leading_turn_without_friction
from .equations.reaction_force import (
    centre_position,
    centre_velocity,
    friction_ratio,
    locus_velocity,
)
from .equations.steady_motion import (
    balanced_rotation,
    circle_radius,
    critical_rolling_rate,
    rest_rates,
    squared_eigenvalue,
    steady_rotation,
)
from .integrable.cycle import PeriodicMotions, exact_bounces
from .numerics.compiled import path_taken
from .problem.can import PAPER_CAN, ParameterError, Parameters
from .problem.effects import Compliance, EffectError, Effects, Gravity, Mass, Restitution
from .problem.outcome import Outcome
from .problem.problem import Problem, ProblemError
from .problem.states import States
from .problem.validation import RefusedError
from .solution import Bounce, Solution
from .solver import (
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
    "Compliance",
    "Divergence",
    "EffectError",
    "Effects",
    "Finding",
    "FindingKind",
    "Gravity",
    "Guard",
    "Impact",
    "Kind",
    "Mass",
    "Outcome",
    "ParameterError",
    "Parameters",
    "PeriodicMotions",
    "Phase",
    "Problem",
    "ProblemError",
    "RefusedError",
    "Rest",
    "Restitution",
    "Solution",
    "SolverError",
    "States",
    "balanced_rotation",
    "boundary_rotation",
    "carries",
    "centre_position",
    "centre_velocity",
    "circle_radius",
    "coming_to_rest",
    "critical_rolling_rate",
    "differences",
    "divergence",
    "exact_bounces",
    "examine",
    "friction_bound",
    "friction_ratio",
    "hypergeometric_pair",
    "is_regular",
    "leading_constants",
    "leading_turn_without_friction",
    "locus_arc",
    "locus_velocity",
    "matched_of",
    "neighbours",
    "paper_constants",
    "path_taken",
    "renamed_method",
    "rest_rates",
    "smallest",
    "solve",
    "squared_eigenvalue",
    "steady_rotation",
]
