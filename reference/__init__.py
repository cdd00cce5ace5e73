"""What is true: the mathematics of the rocking can, dimensionless."""

from reference.exact import Cycles, exact_bounces
from reference.integrate import METHODS, MODELS, SolverError, solve
from reference.outcome import Outcome
from reference.parameters import PAPER_CAN, ParameterError, Parameters
from reference.problem import Problem, ProblemError
from reference.solution import Bounce, Solution
from reference.states import States

__all__ = [
    "METHODS",
    "MODELS",
    "PAPER_CAN",
    "Bounce",
    "Cycles",
    "Outcome",
    "ParameterError",
    "Parameters",
    "Problem",
    "ProblemError",
    "Solution",
    "SolverError",
    "States",
    "exact_bounces",
    "solve",
]
