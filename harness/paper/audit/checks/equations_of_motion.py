"""Section 2: the equations of motion, their scaling, and the planar pendulum."""

from functools import cache

import sympy as sp

from harness.paper.audit.evidence import Both, Fact, IdentityEvidence, check, check_each
from harness.paper.audit.newton_euler import (
    ARM,
    angular_momentum,
    body_rates,
    centre_velocity,
    moment_balance,
    papers_accelerations,
    rate,
)
from harness.paper.audit.symbols import (
    A,
    C,
    Co,
    Expr,
    H,
    Phi,
    Psi,
    R,
    S,
    Theta,
    a,
    a_p,
    c,
    g,
    h,
    k,
    m,
    phi,
    phi_dd,
    psi_dd,
    theta_dd,
    tidy,
)

BALANCE = "Newton and Euler"
RAW_PSI = (
    ((A + m * H**2) * S - m * H * R * Co) * psi_dd
    - m * H * R * theta_dd
    - (C - 2 * A - 2 * m * H**2) * Psi * Phi * Co
    - C * Phi * Theta
    + 2 * m * H * R * Psi * Phi * S
) / (m * R**2)
RAW_PHI = (
    (m * R**2 + m * H**2 + A) * phi_dd
    - ((A + m * H**2 - C - m * R**2) * S * Co - m * R * H * sp.cos(2 * phi)) * Psi**2
    + ((C + m * R**2) * S + m * R * H * Co) * Theta * Psi
) / (m * R**2)
GRAVITY = Co - h * S
"""m g (R cos phi - H sin phi) over m R^2, once times are in sqrt(R/g)."""
RAW_THETA = (
    ((C + m * R**2) * Co - m * R * H * S) * psi_dd
    + (C + m * R**2) * theta_dd
    - C * Psi * Phi * S
    - 2 * m * R * Psi * Phi * (R * S + H * Co)
) / (m * R**2)


@check_each(
    {
        "eq01:raw_eom": (0, 1, 2),
        "eq01:psi_ugly": (0,),
        "eq01:phi_ugly": (1,),
        "eq01:theta_ugly": (2,),
    }
)
def raw_equations(*rows: int) -> IdentityEvidence:
    """Compare rows of eq01:raw_eom with the moments about the contact."""
    printed = sp.Matrix([RAW_PSI, RAW_PHI + GRAVITY, RAW_THETA])
    # the moment about x, minus that about y (phi turns about -y), and the one about z
    derived = sp.diag(1, -1, 1) * moment_balance()
    return IdentityEvidence(
        printed=sp.Matrix([printed[i] for i in rows]),
        derived=sp.Matrix([derived[i] for i in rows]),
        source=BALANCE,
    )


@check("eq01:scalings")
def scalings() -> Fact:
    """With other scales the equations of motion would not be those of a can with R = m = g = 1."""

    def scaled(scales: tuple[Expr, Expr, Expr]) -> bool:
        length, moment, square_of_time = scales
        own = m * R**2
        letters = {h: h * length / R, a: a * moment / own, c: c * moment / own}
        weight = m * g * (R * Co - H * S).subs(letters) / own * square_of_time
        left = [x.subs(letters, simultaneous=True) - x for x in (RAW_PSI, RAW_PHI, RAW_THETA)]
        return all(sp.cancel(x) == 0 for x in (*left, weight - GRAVITY))

    return Fact(
        printed=(R, m * R**2, R / g),
        holds=scaled,
        how="sympy: m, R and g cancel from eq01:raw_eom, which becomes that of R = m = g = 1",
    )


@cache
def _solved() -> tuple[Expr, Expr]:
    """Return the accelerations times the determinant of the balance of moments, and that."""
    balance = moment_balance()
    unknown = sp.Matrix(list(papers_accelerations()))
    # the matrix is invertible wherever sin phi is not 0, so that the solution is the only one
    matrix = balance.jacobian(unknown)
    rest = balance.subs(dict.fromkeys(unknown, 0))
    return -matrix.adjugate() * rest, sp.factor(sp.simplify(matrix.det()))


@check_each(
    {
        "eq01:non_dimensionalised_eom": (psi_dd, theta_dd, phi_dd),
        "eq01:Psi": (psi_dd,),
        "eq01:Theta": (theta_dd,),
        "eq01:Phi": (phi_dd,),
    }
)
def scaled_equations(*letters: Expr) -> IdentityEvidence:
    """Compare printed accelerations with the solution of the balance of moments."""
    accelerations = papers_accelerations()
    solution, determinant = _solved()
    rows = [list(accelerations).index(letter) for letter in letters]
    return IdentityEvidence(
        printed=sp.Matrix([accelerations[letter] for letter in letters]),
        compared=lambda found: found * determinant,
        derived=sp.Matrix([solution[row] for row in rows]),
        source=f"{BALANCE}, solved by Cramer's rule",
    )


@check_each({"eq01:psi": (Psi, psi_dd), "eq01:theta": (Theta, theta_dd), "eq01:phi": (Phi, phi_dd)})
def rates(rate: Expr, acceleration: Expr) -> IdentityEvidence:
    """Insert eq01:Psi, eq01:Theta and eq01:Phi, read with a definition of one of their letters.

    Here `rate` stands for the time derivative of the angle.
    """

    def balance(letter: Expr) -> Expr:
        found = {x: y.subs(rate, letter) for x, y in papers_accelerations().items()}
        found[acceleration] /= letter.diff(rate)
        return moment_balance().subs(found)

    return IdentityEvidence(
        printed=rate,
        compared=balance,
        derived=sp.zeros(3, 1),
        source=f"{BALANCE}, with eq01:Psi, eq01:Theta and eq01:Phi inserted",
    )


ABOUT = sp.diag(a, a, c) + (ARM.dot(ARM) * sp.eye(3) - ARM * ARM.T)
"""The inertia about the contact point."""


@check("text:a_p and c_p")
def moments_about_the_contact() -> IdentityEvidence:
    """Move the inertia to the contact point."""
    return IdentityEvidence(
        printed=sp.Matrix([a + h**2, c + 1]),
        derived=sp.Matrix([ABOUT[0, 0], ABOUT[2, 2]]),
        source="the parallel-axis theorem",
    )


@check("text:k")
def the_constant_k() -> IdentityEvidence:
    """Invert the inertia about the contact, where psi'' and theta'' meet."""
    block = ABOUT[0, 0] * ABOUT[2, 2] - ABOUT[0, 2] ** 2
    return IdentityEvidence(
        printed=k, derived=c / block, source="c over the determinant of the inertia about P"
    )


SLOPE = (h * S - Co) / (a_p + 1)


@check("eq01:nonlin_pendulum")
def planar_pendulum() -> IdentityEvidence:
    """Set the rates to zero in the moment about y."""
    plane = (-moment_balance()[1]).subs({Psi: 0, Theta: 0, psi_dd: 0, theta_dd: 0})
    return IdentityEvidence(printed=SLOPE, derived=sp.solve(plane, phi_dd)[0], source=BALANCE)


@check("text:pendulum solution")
def pendulum_solution() -> Both:
    """Differentiate: with u = phi - arctan(1/h) the equation is u'' = w^2 sin u."""
    constant = sp.Symbol("C_1", positive=True)
    s = sp.Symbol("s", positive=True)
    square = constant - 2 * sp.cos(s)
    shifted = SLOPE.subs(phi, s + sp.atan(1 / h))
    return Both(
        IdentityEvidence(
            printed=1 / square,  # (du/dtau)^2 as printed, s the argument
            corrected=square,
            compared=lambda speed: speed.diff(s) / 2,
            derived=sp.sin(s),
            source="u'' = sin u",
        ),
        IdentityEvidence(
            printed=(h**2 + 1) / (a_p + 1),  # the square of tau/t
            corrected=sp.sqrt(h**2 + 1) / (a_p + 1),
            derived=sp.simplify(sp.expand_trig(shifted) / sp.sin(s)),
            source="phi'' about the balancing angle",
        ),
    )


@check("text:energy")
def conservation_of_energy() -> IdentityEvidence:
    """Differentiate it along eq01:non_dimensionalised_eom."""
    velocity, turning = centre_velocity(), body_rates()[1].dot(angular_momentum()) / 2
    moving = tidy(velocity.dot(velocity) / 2)
    energy = turning + moving + S + h * Co
    return IdentityEvidence(
        printed=energy,
        compared=lambda form: rate(form).subs(papers_accelerations()),
        derived=sp.Integer(0),
        source="its rate along the equations of motion",
    )
