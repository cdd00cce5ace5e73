"""What separates PyBullet as it ships from the matched one, and how hard its solver can try.

The gaps in the order in which they are closed: the body first (its rim, its moments), then what
acts on a body in flight, then the contact and its solver, the timestep last.
"""

from harness.engines.base import TIMESTEP, Effort, Gap

GAPS = (
    Gap(
        name="rim shape",
        settings=("URDF_USE_IMPLICIT_CYLINDER", "collisionMargin"),
        sentence="The rim is a polygon with 32 corners inside a margin of 1 mm.",
    ),
    Gap(
        name="inertia",
        settings=("URDF_USE_INERTIA_FROM_FILE",),
        sentence="The moments are those of the collision shape, not the declared ones.",
    ),
    Gap(
        name="damping",
        settings=("linearDamping", "angularDamping"),
        sentence="Velocities decay at 0.04 per second.",
    ),
    Gap(
        name="velocity clamp",
        settings=("maxJointVelocity",),
        sentence="No component of velocity exceeds 100 m/s or rad/s.",
    ),
    Gap(
        name="stabilisation",
        settings=("contactERP", "contactSlop"),
        sentence="A slop of 0.01 mm is left alone and what is deeper taken away at 8 % a step.",
    ),
    Gap(
        name="solver",
        settings=("solverResidualThreshold", "enableConeFriction"),
        sentence="The sweeps stop at a squared residual of 1e-7.",
    ),
    Gap(
        name="timestep",
        settings=(TIMESTEP,),
        sentence="Steps of 1/240 s are long beside the bounce.",
    ),
)

# a squared residual of 1e-30 is round-off of velocities of 1 m/s; sweeps end there before 1000
_RESIDUAL = ("solverResidualThreshold", 1e-30)

EFFORTS = (
    Effort(name="1 sweep", settings=(_RESIDUAL, ("numSolverIterations", 1))),
    Effort(name="2 sweeps", settings=(_RESIDUAL, ("numSolverIterations", 2))),
    Effort(name="5 sweeps", settings=(_RESIDUAL, ("numSolverIterations", 5))),
    Effort(name="10 sweeps", settings=(_RESIDUAL, ("numSolverIterations", 10))),
    Effort(name="residual 1e-7, as shipped", settings=(("solverResidualThreshold", 1e-7),)),
    Effort(name="converged", settings=(_RESIDUAL, ("numSolverIterations", 1000))),
)
