"""Wrong claims that are made from the right one: series, sums and solutions altered in parts."""

from collections.abc import Iterator
from typing import Any

import sympy as sp

from harness.paper.audit.checks.exact_solution import BRANCHES, RIGHT_RHO
from harness.paper.audit.checks.frobenius import PSI_0, SLOPE_0, C, N, q_n
from harness.paper.audit.checks.inner import q, root
from harness.paper.audit.checks.inner import t as before
from harness.paper.audit.checks.outer import B_LETTERS
from harness.paper.audit.checks.outer import t as outer_t
from harness.paper.audit.evidence import Evidence, IdentityEvidence, Rate
from harness.paper.audit.newton_euler import centre_velocity
from harness.paper.audit.symbols import Co, Expr, I, S, Theta, eps, h, phi, tidy
from tests.harness.paper.audit.mutated_form import with_entry


def all_entries(_: Evidence) -> Iterator[Any]:
    """Yield the branches of eq01:hyper_geom with each entry changed, and rho with its sign."""
    yield sp.conjugate(RIGHT_RHO), BRANCHES
    for place in range(len(BRANCHES)):
        for other in with_entry(BRANCHES, place):
            yield RIGHT_RHO, other.as_immutable()


def energies(evidence: IdentityEvidence) -> Iterator[Expr]:
    """Yield the energy without one of its parts, and with a rate added."""
    energy, velocity = evidence.printed, centre_velocity()
    moving = tidy(velocity.dot(velocity) / 2)
    yield from (energy - moving, moving + S + h * Co, energy - S, energy + Theta)


def matched(_: Evidence) -> Iterator[Expr]:
    """Yield composite solutions that are wrong at the power 1/2 of eps."""
    gap = sp.sqrt(I) - before
    yield sp.sqrt(eps * (q + 1) / I + I * gap**2) - gap**2 / 2
    yield sp.sqrt(eps * q / I**2 + I * gap**2) - gap**2 / 2
    yield sp.sqrt(eps * q / I + I * gap**2) + gap**2 / 2
    yield (I - before**2) / 2


def outer_solutions(form: Expr) -> Iterator[Expr]:
    """Yield (5.6) with another fall, another power of eps, and without or with other sums."""
    fall = (I - outer_t**2) / 2
    first = form - fall
    yield from (2 * fall + first, fall + outer_t + first, I / 2 - outer_t**2 + first)
    yield from (fall, fall - first, fall + eps * first, fall + root * first)
    yield from (form.subs(letter, 0) for letter in (*B_LETTERS[:2], B_LETTERS[-1]))


def inserted(form: Expr) -> Iterator[Expr]:
    """Yield (4.10) without each of its sums, with other factors of them, and without Psi_0."""
    bend, slope, plain = (
        sum(q_n[n] * factor(n) * phi ** (n - 2) for n in N)
        for factor in (lambda n: (n - 2) * (n - 3) / phi**2, lambda n: (n - 2) / phi, lambda _: 1)
    )
    yield from (form - bend, form + bend, form - slope, form - plain, form + plain * phi)
    yield form + sum(q_n[n] * (n - 2) * phi ** (n - 4) for n in N)
    yield form.subs(q_n[3], 0)
    yield from (form.subs(C, 0), form.subs(PSI_0, 0), form.subs(SLOPE_0, 2 * SLOPE_0))


def orders(_: Evidence) -> Iterator[Expr]:
    """Yield orders other than eps^(1/2) log eps."""
    yield from (root, root * sp.log(eps) ** 2, eps)


def series(evidence: Rate) -> Iterator[Expr]:
    """Yield a series with the last power that the order states, and twice the series."""
    yield evidence.printed + phi ** int(evidence.stated - 1)
    yield 2 * evidence.printed
