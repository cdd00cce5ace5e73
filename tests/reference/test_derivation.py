"""The equations of rolling and of its reaction force follow from Newton and Euler.

Everything starts here from the rotation R_WB = Rz(psi) Ry(-phi), the contact point (-1, 0, -h) in
the body, and the laws of motion; nothing is taken from the paper but the claim to be checked.
"""

import numpy as np
import pytest
import sympy as sp

from reference.equations.nonholonomic import accelerations
from reference.equations.reaction_force import contact_force, contact_from_centre, locus_velocity
from reference.problem.can import PAPER_CAN, Parameters
from reference.problem.states import States

a, c, h = sp.symbols("a c h", positive=True)
phi, Phi, Psi, Theta = sp.symbols("phi Phi Psi Theta", real=True)
phi_dd, psi_dd, theta_dd = sp.symbols("phi_dd psi_dd theta_dd", real=True)
S, C = sp.sin(phi), sp.cos(phi)
a_p, c_p = a + h**2, c + 1
k = c / (a + c * a_p)
CANS = [
    PAPER_CAN,
    Parameters(a=0.26, c=0.5, h=0.05),
    Parameters(a=5.6, c=0.5, h=4.0),
    Parameters(a=0.6, c=1.0, h=0.3),
]


def rate(vector: sp.Matrix) -> sp.Matrix:
    """Time derivative of the components."""
    return (
        vector.diff(phi) * Phi
        + vector.diff(Phi) * phi_dd
        + vector.diff(Psi) * psi_dd
        + vector.diff(Theta) * theta_dd
    )


def newton_euler() -> tuple[sp.Matrix, sp.Matrix]:
    """Contact force in the frame I, per m g, and the residual of the moment balance in B."""
    R_IB = sp.Matrix([[C, 0, -S], [0, 1, 0], [S, 0, C]])
    spin_of_I = sp.Matrix([0, 0, Psi])
    omega = sp.Matrix([Psi * S, -Phi, Psi * C])
    Omega = omega + sp.Matrix([0, 0, Theta])
    p_GP = sp.Matrix([-1, 0, -h])
    v_G = -R_IB * Omega.cross(p_GP)
    a_G = rate(v_G) + spin_of_I.cross(v_G)
    force = a_G + sp.Matrix([0, 0, 1])
    inertia = sp.diag(a, a, c)
    moment = inertia * rate(Omega) + omega.cross(inertia * Omega) - p_GP.cross(R_IB.T * force)
    return force, moment


def papers_accelerations() -> dict[sp.Symbol, sp.Expr]:
    """eq01:non_dimensionalised_eom as printed."""
    kc = k * c_p
    return {
        psi_dd: (kc * Phi * Theta + ((kc - 2) * C - h * k * S) * Phi * Psi) / S,
        theta_dd: (
            (-kc * C + h * k * S) * Phi * Theta
            + (-kc * C**2 - k * a_p * S**2 + h * k * 2 * S * C + 2) * Phi * Psi
        )
        / S,
        phi_dd: (
            ((a_p - c_p) * S * C - h * sp.cos(2 * phi)) * Psi**2
            - (c_p * S + h * C) * Theta * Psi
            + h * S
            - C
        )
        / (a_p + 1),
    }


def vanishes(expression: sp.Expr) -> bool:
    """Whether an expression in sin and cos of phi is zero identically."""
    s, q = sp.symbols("s q")
    plain = sp.together(sp.expand_trig(expression)).subs({sp.sin(phi): s, sp.cos(phi): q})
    numerator = sp.Poly(sp.numer(sp.together(plain)), s, q)
    return bool(sp.rem(numerator, sp.Poly(s**2 + q**2 - 1, s, q)).is_zero)


def test_accelerations_balance_moments() -> None:
    _, moment = newton_euler()
    for component in moment.subs(papers_accelerations()):
        assert vanishes(component)


def test_balance_determines_the_accelerations() -> None:
    """The three moments are independent in the three accelerations wherever sin phi is not 0."""
    _, moment = newton_euler()
    determinant = moment.jacobian([phi_dd, psi_dd, theta_dd]).det()
    assert vanishes(determinant**2 - (S * (a_p + 1) * (a + c * a_p)) ** 2)


def test_contact_force() -> None:
    force, _ = newton_euler()
    L = -(S + h * C) * phi_dd - (C - h * S) * Phi**2 - Psi * (Psi * (C - h * S) + Theta)
    N = 1 + (C - h * S) * phi_dd - (S + h * C) * Phi**2
    tangential = -k * Phi * (a * Psi * S + c * h * (Psi * C + Theta))
    assert vanishes(force[0] - L)
    assert vanishes((force[1] - tangential).subs(papers_accelerations()))
    assert vanishes(force[2] - N)


def test_force_in_world_is_the_paper_with_its_sign_mended() -> None:
    """eq01:fx prints L cos psi + M sin psi; turning the frame I gives L cos psi - M sin psi."""
    psi, L, M = sp.symbols("psi L M")
    turned = sp.rot_axis3(-psi) * sp.Matrix([L, M, 0])
    assert turned[0] == L * sp.cos(psi) - M * sp.sin(psi)
    assert turned[1] == L * sp.sin(psi) + M * sp.cos(psi)


def test_locus_moves_by_rotation_alone() -> None:
    """d/dt (x_G + GP) = Theta (-sin psi, cos psi): in I, only the second component is left."""
    R_IB = sp.Matrix([[C, 0, -S], [0, 1, 0], [S, 0, C]])
    p_GP = sp.Matrix([-1, 0, -h])
    Omega = sp.Matrix([Psi * S, -Phi, Psi * C + Theta])
    arm = R_IB * p_GP
    locus = -R_IB * Omega.cross(p_GP) + rate(arm) + sp.Matrix([0, 0, Psi]).cross(arm)
    assert vanishes(locus[0])
    assert vanishes(locus[1] - Theta)
    assert vanishes(locus[2])


def random_states(rng: np.random.Generator, n: int) -> States:
    Psi_, Theta_ = rng.normal(size=(2, n))
    return States(
        phi=rng.uniform(0.05, 1.5, n),
        phi_dot=rng.normal(size=n),
        psi=rng.uniform(-3, 3, n),
        psi_dot=Psi_,
        theta=rng.uniform(-3, 3, n),
        theta_dot=Theta_,
        spin=Psi_ + Theta_,
    )


@pytest.mark.parametrize("can", CANS)
def test_code_solves_newton_euler(can: Parameters) -> None:
    """Accelerations and forces in the code against a linear solve of the symbolic balance."""
    force, moment = newton_euler()
    unknown = [phi_dd, psi_dd, theta_dd]
    values = {a: can.a, c: can.c, h: can.h}
    arguments = (phi, Phi, Psi, Theta)
    matrix = sp.lambdify(arguments, moment.jacobian(unknown).subs(values))
    vector = sp.lambdify(arguments, moment.subs(dict.fromkeys(unknown, 0)).subs(values))
    forces = sp.lambdify((*arguments, *unknown), force.subs(values))
    states = random_states(np.random.default_rng(1), 50)
    code = np.stack(accelerations(states, can), axis=1)
    code_force = np.stack(contact_force(states, can), axis=1)
    for i in range(50):
        now = (states.phi, states.phi_dot, states.psi_dot, states.theta_dot)
        point = [float(v[i]) for v in now]
        M, b = np.array(matrix(*point)), np.array(vector(*point))[:, 0]
        solved = np.linalg.solve(M, -b)
        # what a backward-stable 3 x 3 solve may lose
        bound = 100 * np.finfo(float).eps * np.linalg.cond(M) * np.linalg.norm(solved)
        assert np.abs(code[i] - solved).max() <= bound
        expected = np.array(forces(*point, *solved))[:, 0]
        scale = 1 + np.abs(point).max() ** 2 + np.abs(solved).max()
        assert np.abs(code_force[i] - expected).max() <= bound + 100 * np.finfo(float).eps * scale


def test_contact_point_lies_under_the_rim() -> None:
    """The arm has the length of a rim point and the code turns it with psi."""
    states = random_states(np.random.default_rng(2), 50)
    arm = contact_from_centre(states, PAPER_CAN)
    length = np.sqrt(1 + PAPER_CAN.h**2)
    assert np.allclose(np.linalg.norm(arm, axis=1), length, rtol=4 * np.finfo(float).eps, atol=0)
    across = arm[:, 0] * -np.sin(states.psi) + arm[:, 1] * np.cos(states.psi)
    assert np.abs(across).max() <= 4 * np.finfo(float).eps * length
    along = locus_velocity(states)
    assert np.allclose(np.hypot(along[:, 0], along[:, 1]), np.abs(states.theta_dot), rtol=1e-15)
