"""The reduced equation eq01:Phi_reduced and its Hamiltonian, with letters for its coefficients."""

from collections.abc import Mapping

import sympy as sp

from harness.paper.audit.symbols import Expr, Phi, eps, phi

POWERS = {
    "3": (3, 0),
    "l2": (2, 1),
    "2": (2, 0),
    "l1": (1, 1),
    "1": (1, 0),
    "ll": (0, 2),
    "l0": (0, 1),
    "0": (0, 0),
}
"""Power of 1/phi and of log phi beside each coefficient."""
a_ = {name: sp.Symbol(f"a_{name}", real=True) for name in POWERS}


def bracket(y: Expr, log: Expr, coefficients: Mapping[str, Expr] = a_) -> Expr:
    """Return the sum of eight terms in a nutation and its logarithm."""
    return sum(coefficients[n] * log**j / y**i for n, (i, j) in POWERS.items())


_LOG = sp.log(phi)
FORCE = eps * bracket(phi, _LOG) - 1
"""The right side of eq01:Phi_reduced."""
HAMILTONIAN = (
    Phi**2 / 2
    + phi
    - eps
    * (
        _LOG**2 * (a_["l1"] / 2 + a_["ll"] * phi)
        + ((a_["l0"] - 2 * a_["ll"]) * phi + a_["1"] - a_["l2"] / phi) * _LOG
        + (a_["0"] + 2 * a_["ll"] - a_["l0"]) * phi
        - (a_["2"] + a_["l2"]) / phi
        - a_["3"] / (2 * phi**2)
    )
)
"""eq01:hamiltonian1 put right."""
