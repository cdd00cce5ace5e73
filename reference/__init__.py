"""What is true: the mathematics of the rocking can, dimensionless."""

from reference.analysis.agreement import ENDING, Agreement
from reference.analysis.conditioning import neighbours
from reference.analysis.confirmation import differences
from reference.analysis.lyapunov import Divergence, divergence
from reference.analysis.validity import Finding, Guard, examine
from reference.equations.contact_laws import Kind, Phase
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
    Choice,
    SolverError,
    carries,
    current_method,
    smallest,
    solve,
)

__all__ = [
    "ENDING",
    "METHODS",
    "MODELS",
    "PAPER_CAN",
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
    "carries",
    "current_method",
    "differences",
    "divergence",
    "exact_bounces",
    "examine",
    "neighbours",
    "smallest",
    "solve",
]
