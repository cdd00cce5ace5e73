"""What is true: the mathematics of the rocking can, dimensionless."""

from reference.agreement import ENDING, Agreement
from reference.chaos import Divergence, divergence
from reference.choice import Choice, carries, smallest
from reference.conditioning import neighbours
from reference.confirmation import differences
from reference.contact_modes import Kind, Phase
from reference.effects import EffectError, Effects, Gravity, Mass
from reference.exact import Cycles, exact_bounces
from reference.guard import Finding, Guard, examine
from reference.integrate import METHODS, MODELS, SolverError, solve
from reference.outcome import Outcome
from reference.parameters import PAPER_CAN, ParameterError, Parameters
from reference.problem import Problem, ProblemError
from reference.solution import Bounce, Solution
from reference.states import States

__all__ = [
    "ENDING",
    "METHODS",
    "MODELS",
    "PAPER_CAN",
    "Agreement",
    "Bounce",
    "Choice",
    "Cycles",
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
    "Phase",
    "Problem",
    "ProblemError",
    "Solution",
    "SolverError",
    "States",
    "carries",
    "differences",
    "divergence",
    "exact_bounces",
    "examine",
    "neighbours",
    "smallest",
    "solve",
]
