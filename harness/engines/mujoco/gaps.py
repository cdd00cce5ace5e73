"""What separates MuJoCo as it ships from the matched one, and how hard its solver can try.

The gaps in the order in which they are closed: the contact first, since friction and solver act
through it, the timestep last, since a matched contact is tied to it.
"""

from harness.engines.base import TIMESTEP, Effort, Gap

GAPS = (
    Gap(
        name="compliance",
        settings=("solref", "solimp"),
        sentence="The contact yields with a time constant of 0.02 s, so that the can sinks in.",
    ),
    Gap(
        name="friction regularisation",
        settings=("cone", "impratio"),
        sentence="Friction is as soft as the normal, its cone a pyramid, and the rim creeps.",
    ),
    Gap(
        name="solver",
        settings=("tolerance", "jacobian", "build"),
        sentence="The solver stops at an improvement of 1e-8, and idle stages run.",
    ),
    Gap(
        name="timestep",
        settings=(TIMESTEP,),
        sentence="Steps of 2 ms are long beside the bounce.",
    ),
)

# below 1e-15 the solver's own cost is round-off; 200 iterations are reached by none of its solves
_CONVERGED = (("tolerance", 1e-15), ("iterations", 200), ("ls_iterations", 200))

EFFORTS = (
    Effort(name="1 iteration", settings=(("tolerance", 1e-15), ("iterations", 1))),
    Effort(name="2 iterations", settings=(("tolerance", 1e-15), ("iterations", 2))),
    Effort(name="3 iterations", settings=(("tolerance", 1e-15), ("iterations", 3))),
    Effort(name="tolerance 1e-4", settings=(("tolerance", 1e-4),)),
    Effort(name="tolerance 1e-8, as shipped", settings=(("tolerance", 1e-8),)),
    Effort(name="converged", settings=_CONVERGED),
)
