"""What is true: the mathematics of the rocking can, dimensionless."""

from reference.integrate import SolverError, solve
from reference.outcome import Outcome
from reference.parameters import PAPER_CAN, ParameterError, Parameters
from reference.problem import Problem, ProblemError
from reference.solution import Bounce, Solution
from reference.states import States

__all__ = [
    "PAPER_CAN",
    "Bounce",
    "Outcome",
    "ParameterError",
    "Parameters",
    "Problem",
    "ProblemError",
    "Solution",
    "SolverError",
    "States",
    "solve",
]
