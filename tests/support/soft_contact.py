"""Cans on a contact that gives way: at random, and by a formulation of six degrees of freedom."""

import math

import numpy as np
import scipy
from numpy.typing import NDArray

from reference import Compliance, Effects, Gravity, Mass, Parameters, Problem, Solution, States
from reference.compliant.equations import CompliantEquations
from reference.compliant.integrator import CompliantPath
from reference.equations.patch_friction import friction_of_patch
from reference.equations.reaction_force import centre_position, centre_velocity, turning_in_world
from reference.equations.state_vector import DISSIPATED, SUPPLIED

Floats = NDArray[np.float64]


def random_problem(number: int) -> Problem:
    """Return a can of any shape with any effects; its weight presses it in by 1e-6 to 1e-2."""
    rng = np.random.default_rng(number)

    def perhaps(value: float, chance: float = 0.35) -> float:
        return float(value) if rng.random() < chance else 0.0

    a, h = 10 ** rng.uniform(-0.6, 0.5), 10 ** rng.uniform(-0.7, 0.6)
    can = Parameters(a=a, c=rng.uniform(0.2, 1.9) * a, h=h)
    tilt, across = perhaps(rng.uniform(0, 0.1)), rng.uniform(0, 6.28)
    shaken = perhaps(rng.uniform(0, 0.5))
    gravity = Gravity(
        constant=(
            math.sin(tilt) * math.cos(across),
            math.sin(tilt) * math.sin(across),
            -math.cos(tilt),
        ),
        amplitude=(shaken * rng.uniform(-1, 1), 0.0, shaken * rng.uniform(-1, 1)),
        rate=rng.uniform(0.5, 6),
        phase=rng.uniform(0, 6),
    )
    away, around = rng.uniform(0, 1), rng.uniform(0, 6.28)
    mass = Mass(
        share=rng.uniform(0.01, 0.5),
        x=away * math.cos(around),
        y=away * math.sin(around),
        z=rng.uniform(-1, 1) * h,
    )
    exponent = float(rng.choice([1.0, 1.0, 1.5, 2.0, rng.uniform(1, 2)]))
    stiffness = 10 ** (-exponent * rng.uniform(-6, -2))
    share = perhaps(10 ** rng.uniform(-2, 0.3), 0.6)
    hysteresis = share * stiffness * 10 ** rng.uniform(-1, 1)
    law = Compliance(
        stiffness=stiffness,
        damping=2 * share * math.sqrt(stiffness) if exponent == 1 else hysteresis,
        exponent=exponent,
    )
    mu = float(10 ** rng.uniform(-1.3, 0.3)) if rng.random() < 0.6 else None
    if mu is not None and rng.random() < 0.1:
        mu = 0.0
    drilling = perhaps(10 ** rng.uniform(-4, -1.5)) * (mu != 0.0)
    resistance = perhaps(10 ** rng.uniform(-4, -1.5)) * (mu != 0.0)
    # what excludes another is drawn for those without that other
    contour = perhaps(10 ** rng.uniform(-4, -1.5)) * (mu != 0.0 and not resistance)
    patch = perhaps(10 ** rng.uniform(-4, -0.5)) * (bool(mu) and not drilling)
    static = None if mu is None else mu * (1 + perhaps(rng.uniform(0, 0.6)))
    effects = Effects(
        mu=mu,
        mu_static=static,
        patch=patch,
        drilling=drilling,
        rolling_resistance=resistance,
        contour=contour,
        contour_damping=perhaps(10 ** rng.uniform(-4, -1.5), 0.25),
        film=perhaps(10 ** rng.uniform(-4, -1.5), 0.25),
        boundary_layer=perhaps(10 ** rng.uniform(-4, -1.5), 0.25),
        linear_damping=perhaps(rng.uniform(0, 0.1)),
        angular_damping=perhaps(rng.uniform(0, 0.1)),
        rim=perhaps(rng.uniform(0, 0.3) * min(1, h)),
        gravity=gravity,
        mass=mass if rng.random() < 0.35 else None,
        compliance=law,
    )
    return Problem(
        parameters=can,
        phi=min(rng.uniform(0.02, 1.2) * can.balancing_angle, 1.5),
        theta=rng.uniform(0, 6),
        phi_dot=perhaps(rng.normal()),
        psi_dot=perhaps(rng.normal(), 0.8),
        theta_dot=perhaps(rng.normal(), 0.8),
        duration=rng.uniform(0.5, 3),
        height=perhaps(10 ** rng.uniform(-3, -0.5)),
        effects=effects,
    )


def six_degrees_of_freedom(problem: Problem, start: States, times: Floats) -> tuple[Floats, Floats]:
    """Return centre and axis of a can without point mass, shape (n, 3) each, at the given times.

    The state is the centre, a quaternion, and both velocities in the world. The lowest point of the
    rim is found from the axis alone. Friction is Coulomb's of a rim that slips, or holds it; that
    of a patch is held against a sum over its elements elsewhere.

    Parameters
    ----------
    problem : Problem
    start : States
        Whose first is the state at the release.
    times : ndarray, shape (n,)
    """
    p, effects, law = problem.parameters, problem.effects, problem.effects.compliance
    assert law is not None
    gravity = np.asarray(effects.gravity.constant)
    euler = scipy.spatial.transform.Rotation.from_euler
    # the axis leans away from the contact
    first = euler("ZYZ", [start.psi[0], -start.phi[0], start.theta[0]])
    inertia = np.diag([p.a, p.a, p.c])
    skew = np.array([[[0, 0, 0], [0, 0, 1], [0, -1, 0]], [[0, 0, -1], [0, 0, 0], [1, 0, 0]],
                     [[0, 1, 0], [-1, 0, 0], [0, 0, 0]]], dtype=float)  # fmt: skip

    def rate(_: float, y: Floats) -> Floats:
        r, q, v, w = y[:3], y[3:7], y[7:10], y[10:]
        turned = scipy.spatial.transform.Rotation.from_quat(q).as_matrix()
        axis = turned[:, 2]
        level = np.array([0.0, 0.0, -1.0]) + axis[2] * axis
        out = level / np.linalg.norm(level)
        arm = out - p.h * axis
        depth, u = -(r + arm)[2], v + np.cross(w, arm)
        if law.exponent == 1:
            N = law.stiffness * depth - law.damping * u[2]
        else:
            N = depth**law.exponent * (law.stiffness - law.damping * u[2])
        world = turned @ inertia @ turned.T
        back = np.linalg.inv(world)
        drag = np.cross(w, world @ w) + effects.angular_damping * world @ w
        drag -= _against_running(axis, w, N, effects)

        def accelerations(force: Floats) -> tuple[Floats, Floats]:
            return gravity + force, back @ (np.cross(arm, force) - drag)

        force = np.array([0.0, 0.0, N])
        if effects.mu is not None and effects.patch:
            moved = np.array([[u[0]], [u[1]], [effects.patch * w[2]]])
            shared = effects.mu * N * friction_of_patch(moved)[:, 0]
            force[:2] = shared[:2]
            drag -= np.array([0.0, 0.0, effects.patch * shared[2]])
        elif effects.mu is not None:
            force[:2] = -effects.mu * N * u[:2] / np.linalg.norm(u[:2])
        else:
            # out turns with the axis: its rate from that of its level part
            spun = np.cross(w, axis)
            tilting = spun[2] * axis + axis[2] * spun
            moved = (tilting - out * (out @ tilting)) / np.linalg.norm(level) - p.h * spun
            free, turning = accelerations(force)
            slips = free + np.cross(turning, arm) + np.cross(w, moved)
            K = np.eye(3) - np.einsum("aij,a->ij", skew, arm) @ back @ np.einsum(
                "aij,a->ij", skew, arm
            )
            force[:2] = -np.linalg.solve(K[:2, :2], slips[:2])
        a, alpha = accelerations(force)
        x, y_, z, s = q
        spin = 0.5 * np.array(
            [
                s * w[0] + w[1] * z - w[2] * y_,
                s * w[1] + w[2] * x - w[0] * z,
                s * w[2] + w[0] * y_ - w[1] * x,
                -(w[0] * x + w[1] * y_ + w[2] * z),
            ]
        )
        return np.concatenate([v, spin, a, alpha])

    y0 = np.concatenate(
        [
            centre_position(start, p, effects)[0],
            first.as_quat(),
            centre_velocity(start, p, effects)[0],
            turning_in_world(start)[0],
        ]
    )
    found = scipy.integrate.solve_ivp(
        rate, (0, times[-1]), y0, "DOP853", times, rtol=3e-14, atol=1e-15
    )
    turned = scipy.spatial.transform.Rotation.from_quat(found.y[3:7].T)
    return found.y[:3].T, turned.as_matrix()[:, :, 2]


def _against_running(axis: Floats, w: Floats, N: float, effects: Effects) -> Floats:
    """Return the moment in the world, shape (3,), of the laws that oppose theta'."""
    sine = math.hypot(axis[0], axis[1])
    # w = psi' z + phi' e + theta' axis, with e and z across this horizontal line
    line = (axis[2] * np.array([0.0, 0.0, 1.0]) - axis) / sine
    rate = -float(w @ line) / sine
    force = effects.contour * N * np.sign(rate) + effects.contour_damping * rate
    force += effects.film * rate / sine + effects.boundary_layer * math.sqrt(abs(rate)) * rate
    return np.asarray(line * force / sine)


def energies(found: Solution) -> Floats:
    """Return the energy that is there and has been lost, less that supplied, piece by piece."""
    path = found.path
    assert isinstance(path, CompliantPath)
    law = found.problem.effects.compliance
    assert law is not None
    equations = CompliantEquations(
        parameters=found.problem.parameters, effects=found.problem.effects, law=law
    )
    return np.array(
        [
            equations.energy(piece.start[:, None], piece.mode)[0]
            + piece.start[DISSIPATED]
            - piece.start[SUPPLIED]
            for piece in path.pieces
        ]
    )
