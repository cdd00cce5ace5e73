"""Wrong claims that the checks of the audit have to refuse, and the right ones.

Of every claim that is wrong as printed, the printed form is one wrong claim. Others are listed in
`WRONG_CLAIMS`; where a form is not listed, it is changed in one place by `mutated`.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import mpmath as mp
import sympy as sp

from harness.paper.audit import CLAIMS, paper_can
from harness.paper.audit.checks.inner import P, Q, q, root, x
from harness.paper.audit.checks.outer import CLOSED_FORMS, INTEGRANDS, time
from harness.paper.audit.checks.outer import t as outer_t
from harness.paper.audit.checks.steady_sets import CANS
from harness.paper.audit.evidence import (
    Both,
    Evidence,
    Fact,
    IdentityEvidence,
    Number,
    Rate,
)
from harness.paper.audit.newton_euler import VERTICAL
from harness.paper.audit.reduced_form import POWERS
from harness.paper.audit.symbols import (
    Co,
    I,
    Phi,
    Psi,
    R,
    S,
    T,
    Theta,
    a,
    c,
    c_p,
    eps,
    g,
    h,
    log_phi,
    m,
    phi,
)
from tests.harness.paper.audit.altered_claims import (
    all_entries,
    energies,
    inserted,
    matched,
    orders,
    outer_solutions,
    series,
)
from tests.harness.paper.audit.mutated_form import HALF, mutated

C_1, s = sp.symbols("C_1 s", positive=True)
OVER = sp.Symbol("E_over_phi", positive=True)
SLOPE = sp.Symbol("kh")
LEAN = sp.sqrt(q) * T - Q
ALONG, ACROSS = sp.Matrix([1, 0, 0]), sp.Matrix([0, 1, 0])
MOVED, PUSHED = sp.symbols("d_dt_p dL_dq")
L_AXIS = sp.Symbol("L_axis")
LEVELS = (1e-3, 2e-3, 3e-3, 4e-3, 5e-3)
GAMMA, BETA = sp.symbols("gamma beta", real=True)

WrongClaims = Iterable[Any] | Callable[[Any], Iterable[Any]]
"""Wrong claims, or what makes them of the evidence about the right one."""

WRONG_CLAIMS: Mapping[str | tuple[str, int], WrongClaims] = {
    # section 2
    "eq01:scalings": (
        (2 * R, m * R**2, R / g),
        (R, m * R, R / g),
        (R, 2 * m * R**2, R / g),
        (R, m * R**2, g / R),
    ),
    **{
        f"eq01:{angle}": lambda e: (-e.printed, 2 * e.printed, e.printed / 2)
        for angle in ("psi", "theta", "phi")
    },
    ("text:pendulum solution", 0): lambda e: (C_1 + 2 * sp.cos(s), C_1 - sp.cos(s), e.printed**2),
    "text:energy": energies,
    "text:GP": tuple(map(sp.Matrix, ([1, 0, -h], [0, -1, -h], [-1, 0, h], [-2, 0, -h]))),
    "text:contact point and the can": lambda e: (2 * e.printed, -e.printed),
    "text:sense of the nutation": (-2 * phi, sp.pi - phi),
    "text:simultaneous impact": (sp.pi / 6, sp.atan(1 / h)),
    "text:range of phi": ((0 * phi, sp.pi), (0 * phi, sp.pi / 4), (-sp.pi / 2, sp.pi / 2)),
    # section 3
    "text:only static equilibrium": (0, 2),
    "text:centre-like": lambda e: (2 * e.printed, e.printed / 2),
    "text:saddle at the balance": ("centre",),
    "text:range of S_rest": lambda e: (
        ((0, e.printed[1][0]),),
        ((0, e.printed[1][1]),),
        ((e.printed[0][1], e.printed[1][1]),),
    ),
    "text:steady beyond phi*": ("do not exist",),
    "text:1-D manifold": (0, 2),
    "text:1-D set": (0, 2),
    ("eq01:equilibrium", 1): (("phi*",), ("other",)),
    "caption:fig01:eqm_comparison": (("phi*",), ()),
    # straight rolling, and a balanced can that rotates too
    ("text:balanced at rest", 0): (
        (sp.Integer(0), sp.Integer(1)),
        (sp.Integer(1), (a - c) * h / sp.sqrt(1 + h**2) / (c_p + h**2)),
    ),
    ("text:balanced at rest", 1): (sp.false, a < c, a > c, sp.Ne(a, c)),
    ("text:lying and rolling", 1): (CANS[4], CANS[5]),
    ("text:lying and rolling", 2): (sp.false, h > c_p, h < c, h < c_p + 1),
    "eq01:comrest": (
        Psi * (Co - h * S) - Theta,
        Psi * (Co - h * S) + 2 * Theta,
        Psi * (Co + h * S) + Theta,
    ),
    "text:circle for all": ((sp.Integer(0),),),
    # section 4
    ("eq01:hyper_geom", 0): all_entries,
    "caption:fig01:frob_comp": (-3, -1, 2),
    "text:growth of the sum": (2,),
    ("eq01:A_sol", 0): lambda e: (2 * e.printed, e.printed + phi, e.printed + phi**2),
    **{
        # Psi + Theta, a logarithm, shows at the lowest order only, Psi at every one
        ("text:conserved", part): lambda e: (
            2 * e.printed,
            e.printed + Psi * phi**2,
            e.printed - Psi * phi**2 * log_phi,
        )
        for part in (0, 1)
    },
    "caption:fig01:conserved": (("Psi",), ("B_0", "Theta")),
    "eq01:Psi0": (-2, -1, 1),
    "eq0:Psi2": lambda e: (
        (-2, sp.Integer(0)),
        (-1, e.printed[1]),
        (-2, phi * e.printed[1]),
        (-2, 2 * e.printed[1]),
    ),
    **dict.fromkeys(
        (
            ("eq01:psi_orig", 0),
            ("eq01:theta_orig", 0),
            ("eq01:psi_series", 0),
            ("eq01:theta_series", 0),
            ("eq01:series_sols", 0),
            ("eq01:series_sols", 2),
        ),
        series,
    ),
    "text:log terms": (0, 2),
    "text:Frobenius ansatz": (2, 3),
    "text:Psi_-2 inserted": lambda e: inserted(e.printed),
    "text:reason of the logarithms": (({GAMMA: 2 + BETA**2},),),
    "text:regular singular point": (-1, -2),
    # section 4.3 and appendix D
    **{(f"app:a_{name}", 1): lambda e: (2 * e.printed, -e.printed) for name in POWERS},
    ("eq01:Phi_reduced_intermediate", 0): lambda e: (
        e.printed - {(-3, 0)},
        e.printed - {(0, 1)},
        e.printed | {(-1, 2)},
    ),
    ("eq01:Phi_reduced_intermediate", 1): ((1, 0), (2, 2)),
    ("eq01:Phi_reduced_intermediate", 2): lambda e: (
        {**e.printed, name: -e.printed[name]} for name in POWERS
    ),
    "text:quadratic coefficients": lambda e: (
        e.printed - {(1, 1)},
        e.printed | {(1, 0)},
        e.printed - {(2, 0)},
    ),
    "eq01:Phi_reduced": lambda e: ({**e.printed, name: -e.printed[name]} for name in POWERS),
    "text:series suffice": ("up to phi",),
    "text:errors of no account": ("period",),
    "text:no balance": (1, 2),
    "text:eps as mediator": lambda e: (e.printed[::-1], (*e.printed[1::-1], e.printed[2])),
    "text:period": ("keeps",),
    # section 5.1 and appendices F and G
    **{
        f"app:{name}": lambda e: (
            other
            for other in mutated(e.printed)
            # another constant of integration is as good
            if sp.expand(other - e.printed).diff(time, 2) != 0
        )
        for name in INTEGRANDS
    },
    "eq01:integrals": lambda e: (
        {name: e.printed[name] for name in e.printed if name != "0"},
        e.printed | {"l3": e.printed["l2"]},
        e.printed | {"l2": e.printed["l1"]},
        e.printed | {"3": (-e.printed["3"][0], 2)},
        e.printed | {"ll": (e.printed["l0"][0], 2)},
        e.printed | {"1": (e.printed["1"][0], 1)},
        e.printed | {"2": (1 / (1 + time**2) ** 2, 2)},
    ),
    ("eq01:outer_sol", 0): lambda e: mutated(e.printed),
    "eq01:outer_solution": lambda e: (
        e.printed | {"J_3": CLOSED_FORMS["J_3"]},
        e.printed | {"J_ll": CLOSED_FORMS["J_ll"]},
        e.printed | {"J_1": 2 * e.printed["J_1"]},
        # another slope at the release, in single integrals and in the whole
        e.printed | {"J_1": e.printed["J_1"] + time},
        e.printed | {"J_3": e.printed["J_3"] + 5 * time},
        e.printed | {"phi": e.printed["phi"] + eps * outer_t},
        *(e.printed | {"phi": other} for other in outer_solutions(e.printed["phi"])),
        *(e.printed | {"argument": other} for other in (outer_t, outer_t / I, outer_t**2 / I)),
    ),
    "text:singular J": ({"J_3"}, {"J_2", "J_3"}),
    # section 5.2 and 5.4
    "eq01:inner_scalings": ((HALF, 1), (1, 1), (HALF, sp.Rational(1, 3))),
    ("eq01:inner_solution", 0): (
        sp.sqrt(2 * P**2 + LEAN**2 / P**2),
        sp.sqrt(P**2 + LEAN**2 / P),
        sp.sqrt(P**2 + (q * T - Q) ** 2 / P**2),
    ),
    ("eq01:inner_solution", 1): (0, 1, 3),
    ("text:inner precession", 0): (
        2 / x**2 - root * SLOPE / x,
        1 / x**2 + root * SLOPE / x,
        1 / x**2,
    ),
    ("text:inner precession", 1): ((0.5, 1), (1, 0), (1, 3)),
    "text:limits of the turn": ((2 * sp.pi, sp.oo), (sp.pi, 2 * sp.pi), (sp.Integer(0), sp.oo)),
    "text:inner ansatz": orders,
    "text:inner valid for T<0": (("T > 0",),),
    # sections 5 and 5.3
    **{
        label: (mp.mpf("0.25"), mp.mpf(1))
        for label in ("text:outer region", "text:regular perturbation")
    },
    "text:inner region": (2 * sp.sqrt(I) * T, I * T, T),
    ("eq01:uniformly_valid_solution", 1): (1, 3),
    "text:matched agreement": matched,
    "caption:fig01:inner_outer_comp": (0.0, 0.2),
    # section 6
    ("eq01:boundary", 1): lambda e: mutated(e.printed),
    "caption:fig01:left_or_right": lambda e: (
        1.1 * e.printed,
        e.printed / 1.1,
        -e.printed,
        1 / e.printed,
    ),
    "text:circle": ((0.95, 1.0), (float(paper_can.h), 1.0), (1.0, 0.5), (1.0, 1.1)),
    "text:terms discarded": (mp.mpf(0), mp.mpf("1.5")),
    "text:locus barely moves": ("inner",),
    "text:panel a": (("outer", "inner"),),
    "text:thick disk": (("thin",), ()),
    "text:panel b": ((2.0, 1e-5, 2.0), (0.0, 1e-5, 20.0), (0.0, 1e-5, 10.0)),
    "caption:fig01:can_fall": (0.5, 2.0, 0.99),
    "caption:fig01:contact_pt_motion": (
        (0.72667, 7),
        (1.7267, -7),
        (1.7267, 7.2),
        (1.70, 7),
    ),
    **{
        label: (*mutated(h / (a + h**2)), h / (a + h**2 + 1))
        for label in ("text:bound approached", "text:higher order")
    },
    "text:outer friction": (("inner", "outer"),),
    "text:fast release": ("none", "small"),
    "text:small a_p and friction": ("small for every small a_p",),
    # appendix B
    "app:Euler-Lagrange": (MOVED + PUSHED, 2 * MOVED - PUSHED, MOVED - 2 * PUSHED),
    # appendix C
    "text:lines of action": tuple(
        sp.Matrix.hstack(*forces) for forces in ((ACROSS, VERTICAL), (ALONG, ACROSS))
    ),
    "text:F_y in proportion": (Psi, Psi * phi**2),
    "text:B_0 as momentum": ("H_z^G",),
    "text:the other constant": ("H_z^B", "H_z^G", "Theta + Psi"),
    "text:momenta in short": (("H_z^B",), ("H_z^G",), ("H_z^B", "H_z^B")),
    "text:constants as momenta": (("B_0",),),
    "text:eps as momenta": ("H_z^B", "H_z^G", "Theta + Psi"),
    "text:sum in proportion": ("H_z^G",),
    "text:effect of friction": ("beside the momenta",),
    "text:small F_y": ("F_x^I", "N"),
    "text:H_z^G as momentum": lambda e: (L_AXIS, e.printed - L_AXIS),
    "caption:fig01:conserved_quantity_diagram": lambda e: (
        e.printed - {("N", "z^B")},
        e.printed - {("F_x^I", "z^G")},
    ),
    # appendix E
    "eqA:ham1": lambda e: mutated(e.printed - Phi**2 / 2),  # Phi is constant here
    "eqA:ham2": lambda e: (-e.printed, e.printed + Phi**2, e.printed + Phi),
    "eq01:hamiltonian": ((1, 1, 0), (2, 2, 0), (2, 1, 1)),
    "text:clockwise contours": ("anticlockwise",),
    "text:period integral": (1 / Phi, 2 * Phi, 2 / Phi**2 / 3, -2 / Phi),
    "text:T at eps=0": lambda e: (e.printed / 2, 2 / (2 * phi + OVER)),
    "text:taller cans fall slower": ("not longer",),
    "caption:repulsion": ("a_l2", "a_2", "a_1"),
    "text:symmetry of the contours": (-2 * Phi, 1 - Phi, Phi + phi),
    "text:centre of the portrait": ("phi*",),
    "caption:fig01:hamiltonian_contours": (
        (7e-4, *LEVELS),
        (7.5e-5, *LEVELS),
        (7.5e-4, *LEVELS[:4], 5e-4),
    ),
    # numbers and references
    "eq01:initial_conditions": lambda e: (
        ("0.1003", *e.printed[1:]),
        ("0.1001", "-0.0998", *e.printed[2:]),
        ("0.1001", "0.1000", *e.printed[2:]),
        ("0.1001", "-0.1000", mp.pi / 99, "rad/s"),
    ),
    **{
        label: lambda e: (e.printed * eps**HALF, e.printed / eps ** sp.Rational(1, 4), e.printed**2)
        for label in ("text:eps^(1/2)", "eq01:epsilon_zeta")
    },
    "text:same order": (("B_0", "Psi"), ("phi", "B_-2"), ("Psi", "B_-2")),
    "text:reference to S_bal": ("eq01:static_eqm",),
    "caption:fig01:hamiltonian_3D": ("eqA:ham1",),
    "caption:reference of the contours": ("eqA:ham2",),
    "text:reference to panel d": ("fig01:eqm_comparison",),
    "text:bookmarks": ("(4.18)",),
    **dict.fromkeys(
        ("eq01:simultaneous", "text:slopes in (4.16)"), ((-1, 0, -2), (1, -2, 0), (1, 0, 0))
    ),
    "text:every integral": lambda e: (e.printed - {"J_l0"}, e.printed - {"J_3"}),
    "caption:axes of the locus": ("x_G",),
    "caption:other axis of the locus": ("y_G",),
}
"""By the label of the claim, and the number of the part where there are several parts."""
RIGHT_AS_PRINTED = {claim.label for claim in CLAIMS if not claim.errors}
"""Some checks know the right form of a claim that is printed right, too."""


def parts_of(evidence: Evidence) -> list[Evidence]:
    """Return the single pieces of evidence, those of a `Both` within a `Both` too."""
    if isinstance(evidence, Both):
        return [single for part in evidence.parts for single in parts_of(part)]
    return [evidence]


def right_claim(evidence: Evidence) -> Evidence:
    """Return the same evidence about the right claim: itself, where the printed one is right."""
    match evidence:
        case Both():
            return Both(*map(right_claim, evidence.parts))
        case Number():
            return replace(evidence, printed=_written(evidence, mp.mpmathify(evidence.value)))
        case Rate(corrected_to=power) if power is not None:
            return right_claim(replace(evidence, stated=power, corrected_to=None))
        case IdentityEvidence() | Rate() | Fact() if evidence.corrected is not None:
            return replace(evidence, printed=evidence.corrected)
    return evidence


def wrong_claims(label: str, evidence: Evidence) -> Iterator[Evidence]:
    """Yield the same evidence about wrong claims, each of which it has to refuse.

    Of a claim with several parts one part that refuses is enough.
    """
    parts = parts_of(evidence)
    for number, part in enumerate(parts):
        right = right_claim(part)
        match right:
            case Number():
                for step in (-2, 2):  # units in the last place
                    value = mp.mpf(right.printed) + step * _unit(right)
                    yield replace(right, printed=_written(right, value))
            case IdentityEvidence() | Rate() | Fact():
                assert isinstance(part, type(right))
                if right.printed is not part.printed and label not in RIGHT_AS_PRINTED:
                    yield replace(right, printed=part.printed)
                for other in _others(label if len(parts) == 1 else (label, number), right):
                    yield replace(right, printed=other)
                if isinstance(right, Rate):
                    yield replace(right, stated=right.stated + 1)


def _others(key: str | tuple[str, int], right: IdentityEvidence | Rate | Fact) -> Iterable[Any]:
    if key not in WRONG_CLAIMS:
        # of a statement in words the printed one is the only other
        return () if isinstance(right, Fact) else mutated(right.printed)
    listed = WRONG_CLAIMS[key]
    return listed(right) if callable(listed) else listed


def _places(number: Number) -> tuple[int, int]:
    """Return the decimals of the mantissa and the exponent of a printed number."""
    mantissa, _, exponent = number.printed.lower().partition("e")
    return len(mantissa.partition(".")[2]), int(exponent or 0)


def _unit(number: Number) -> mp.mpf:
    places, exponent = _places(number)
    return mp.mpf(10) ** (exponent - places)


def _written(number: Number, value: mp.mpf) -> str:
    places, exponent = _places(number)
    text = f"{float(value / mp.mpf(10) ** exponent):.{places}f}"
    return f"{text}e{exponent}" if exponent else text
