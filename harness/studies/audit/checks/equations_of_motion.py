"""Section 2: the equations of motion, their scaling, and the planar pendulum."""

from functools import partial

import mpmath as mp
import sympy as sp

from harness.studies.audit.evidence import Both, Fact, Identity
from harness.studies.audit.newton_euler import ARM, moment_balance, papers_accelerations
from harness.studies.audit.registry import claim
from harness.studies.audit.symbols import (
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


def _raw(*rows: int) -> Identity:
    """Compare rows of eq01:raw_eom with the moments about the contact."""
    printed = sp.Matrix([RAW_PSI, RAW_PHI + GRAVITY, RAW_THETA])
    # the moment about x, minus that about y (phi turns about -y), and the one about z
    derived = sp.diag(1, -1, 1) * moment_balance()
    return Identity(
        printed=sp.Matrix([printed[i] for i in rows]),
        derived=sp.Matrix([derived[i] for i in rows]),
        source=BALANCE,
    )


for _label, _rows, _name, _says in (
    ("eq01:raw_eom", (0, 1, 2), "raw_equations", "the three equations of motion"),
    ("eq01:psi_ugly", (0,), "raw_psi", "moment about the x axis of the body"),
    ("eq01:phi_ugly", (1,), "raw_phi", "moment about the y axis of the body"),
    ("eq01:theta_ugly", (2,), "raw_theta", "moment about the symmetry axis"),
):
    claim(_label, "2", _says, name=_name)(partial(_raw, *_rows))


@claim("eq01:scalings", "2", "lengths in R, moments in m R^2, times in sqrt(R/g)")
def scalings() -> Fact:
    """No dimension is left in the equations of motion."""
    weight = m * g * (R * Co - H * S) / (m * R**2) * (R / g)  # times t^2
    left = sp.Tuple(*(sp.cancel(x) for x in (RAW_PSI, RAW_PHI, RAW_THETA, weight))).free_symbols
    return Fact(
        true=not left & {m, R, g} and sp.cancel(weight - GRAVITY) == 0,
        how="sympy: m, R and g cancel from eq01:raw_eom",
    )


def _balanced(*letters: Expr) -> Identity:
    """Insert printed accelerations into the balance of moments and solve it for them again."""
    accelerations = papers_accelerations()
    balance = moment_balance()
    unknown = sp.Matrix(list(accelerations))
    # the matrix is invertible wherever sin phi is not 0, so that the solution is the only one
    matrix = balance.jacobian(unknown)
    rest = balance.subs(dict.fromkeys(unknown, 0))
    determinant = sp.factor(sp.simplify(matrix.det()))
    rows = [list(accelerations).index(letter) for letter in letters]
    adjugate = matrix.adjugate()
    return Identity(
        printed=sp.Matrix([accelerations[letter] * determinant for letter in letters]),
        derived=sp.Matrix([-(adjugate * rest)[row] for row in rows]),
        source=f"{BALANCE}, solved by Cramer's rule",
    )


for _label, _letters, _name, _says in (
    (
        "eq01:non_dimensionalised_eom",
        (psi_dd, theta_dd, phi_dd),
        "scaled_equations",
        "the equations of motion without dimensions",
    ),
    ("eq01:Psi", (psi_dd,), "scaled_psi", "Psi' sin phi = ..."),
    ("eq01:Theta", (theta_dd,), "scaled_theta", "Theta' sin phi = ..."),
    ("eq01:Phi", (phi_dd,), "scaled_phi", "Phi' (a_p + 1) = ..."),
):
    claim(_label, "2", _says, name=_name)(partial(_balanced, *_letters))


def _defined(letter: str) -> Fact:
    """Definitions of new letters: consistent if the other equations hold with them."""
    balance = moment_balance().subs(papers_accelerations())
    point = {phi: sp.Rational(7, 10), Phi: 2, Psi: 3, Theta: -1, a: 1, c: 1, h: 2}
    size = max(abs(mp.mpmathify(sp.N(x.subs(point), 30))) for x in balance)
    return Fact(
        true=bool(size < mp.mpf("1e-25")),
        how=f"definition of {letter}; with it the balance of moments closes to {mp.nstr(size, 2)}",
    )


for _label, _letter in (
    ("eq01:psi", "Psi = psi'"),
    ("eq01:theta", "Theta = theta'"),
    ("eq01:phi", "Phi = phi'"),
):
    claim(_label, "2", _letter, name="rates")(partial(_defined, _letter))


@claim("text:a_p and c_p", "2", "a_p = a + h^2 and c_p = c + 1 are moments about the contact point")
def moments_about_the_contact() -> Identity:
    """Move the inertia to the contact point."""
    about = sp.diag(a, a, c) + (ARM.dot(ARM) * sp.eye(3) - ARM * ARM.T)
    return Identity(
        printed=sp.Matrix([a + h**2, c + 1]),
        derived=sp.Matrix([about[0, 0], about[2, 2]]),
        source="the parallel-axis theorem",
    )


@claim("text:k", "2", "k = c/(a + c a_p)")
def the_constant_k() -> Identity:
    """Invert the inertia about the contact, where psi'' and theta'' meet."""
    about = sp.diag(a, a, c) + (ARM.dot(ARM) * sp.eye(3) - ARM * ARM.T)
    block = about[0, 0] * about[2, 2] - about[0, 2] ** 2
    return Identity(
        printed=k, derived=c / block, source="c over the determinant of the inertia about P"
    )


SLOPE = (h * S - Co) / (a_p + 1)


@claim("eq01:nonlin_pendulum", "2", "phi'' = (h sin phi - cos phi)/(a_p + 1) for Psi = Theta = 0")
def planar_pendulum() -> Identity:
    """Set the rates to zero in the moment about y."""
    plane = (-moment_balance()[1]).subs({Psi: 0, Theta: 0, psi_dd: 0, theta_dd: 0})
    return Identity(printed=SLOPE, derived=sp.solve(plane, phi_dd)[0], source=BALANCE)


@claim(
    "text:pendulum solution",
    "2",
    "phi(t) = arctan(1/h) +- int^tau (C_1 - 2 cos s)^(-1/2) ds + C_2, "
    "tau = sqrt((h^2+1)/(a_p+1)) t",
)
def pendulum_solution() -> Both:
    """Differentiate: with u = phi - arctan(1/h) the equation is u'' = w^2 sin u."""
    constant = sp.Symbol("C_1", positive=True)
    s = sp.Symbol("s", positive=True)
    square = (constant - 2 * sp.cos(s)) ** -1  # (du/dtau)^2 as printed, s the argument
    printed = square.diff(s) / 2
    right = (constant - 2 * sp.cos(s)).diff(s) / 2
    frequency = sp.sqrt(sp.sqrt(h**2 + 1) / (a_p + 1))
    shifted = SLOPE.subs(phi, s + sp.atan(1 / h))
    return Both(
        parts=(
            Identity(
                printed=printed,
                corrected=right,
                derived=sp.sin(s),
                source="u'' = sin u",
                correct="tau + C_2 = +- int^(phi - phi*) (C_1 - 2 cos s)^(-1/2) ds",
            ),
            _frequency(frequency, shifted, s),
        )
    )


def _frequency(frequency: Expr, shifted: Expr, s: Expr) -> Identity:
    """Return the evidence for the scale of time."""
    derived = sp.simplify(sp.expand_trig(shifted) / sp.sin(s))
    return Identity(
        printed=(h**2 + 1) / (a_p + 1),
        corrected=sp.simplify(frequency**2),
        derived=derived,
        source="phi'' about the balancing angle",
        correct="tau = (h^2+1)^(1/4) t/sqrt(a_p+1)",
    )
