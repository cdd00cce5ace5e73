"""Which model carries a problem: the smallest one, from its effects and its release.

    pendulum      nothing is declared and nothing turns: the can moves in a plane      2 equations
    frictionless  mu = 0: one degree of freedom beside two conserved momenta           2
    rolling       nothing is declared: the rim never slips                             4
    coulomb       slip is declared: sticks while it may, slips beyond                  6
    general       anything else: six velocities, and the angles and the time that the forces
                  depend on                                                            up to 9

Psi, theta, the time and the contact point are quadratures wherever nothing depends on them.
"exact", the closed solution, is of the same can as "rolling"; "reduced" and "asymptotic" are
approximations of it, good for nothing more.
"""

from dataclasses import dataclass

from reference.contact_modes import Mode
from reference.newton_euler import GeneralEquations
from reference.problem import Problem

CARRIED = frozenset(
    {"slip", "drilling", "rolling_resistance", "damping", "rim", "tilt", "shake", "point_mass"}
)
"""Effects that some model carries: all but those of an impact and of a soft contact."""

OF_ROLLING = ("rolling", "exact", "reduced", "asymptotic")


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """A model for a problem.

    Attributes
    ----------
    model : str
    equations : int
        First-order equations that are integrated together, quadratures apart.
    why : str
        A sentence.
    """

    model: str
    equations: int
    why: str


def smallest(problem: Problem) -> Choice:
    """Return the smallest model that carries a problem."""
    effects, declared = problem.effects, problem.effects.declared()
    if declared == ("slip",) and effects.mu == 0:
        why = "The plane is declared without friction: two momenta are conserved."
        return Choice(model="frictionless", equations=2, why=why)
    if declared == ("slip",):
        why = f"Friction {effects.mu:g} is declared: the rim sticks while it may, and slips beyond."
        return Choice(model="coulomb", equations=6, why=why)
    if declared:
        named = ", ".join(name.replace("_", " ") for name in declared)
        rest = "it takes the general can." if len(declared) == 1 else "they take the general can."
        return Choice(
            model="general",
            equations=equations_of("general", problem),
            why=f"Declared: {named}; {rest}",
        )
    if problem.psi_dot == problem.theta_dot == 0:
        why = "No effect is declared and nothing turns at the release: the can moves in a plane."
        return Choice(model="pendulum", equations=2, why=why)
    why = "No effect is declared and the can turns: it rolls without slipping."
    return Choice(model="rolling", equations=4, why=why)


def equations_of(model: str, problem: Problem) -> int:
    """Return how many equations a model integrates together for a problem."""
    if model == "general":
        equations = GeneralEquations(parameters=problem.parameters, effects=problem.effects)
        return len(equations.core(Mode(slips=problem.effects.mu is not None)))
    counts = {"pendulum": 2, "frictionless": 2, "coulomb": 6, "reduced": 2}
    return counts.get(model, 0 if model in {"exact", "asymptotic"} else 4)


def carries(model: str, problem: Problem) -> bool:
    """Whether a model is as large as a problem asks, or an approximation of one that is."""
    needed = smallest(problem).model
    larger = {
        "pendulum": ("pendulum", *OF_ROLLING, "coulomb", "general"),
        "rolling": (*OF_ROLLING, "coulomb", "general"),
        "frictionless": ("frictionless", "coulomb", "general"),
        "coulomb": ("coulomb", "general"),
        "general": ("general",),
    }
    return model in larger[needed]
