"""The errors that the wrong claims come down to: several claims may be wrong for one reason."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum


class Weight(Enum):
    """What an error does to the rest of the paper, gravest first."""

    SUBSTANTIAL = "errors that change numbers or conclusions"
    FORMULA = "false formulas and statements that leave the results as they are"
    TYPOGRAPHICAL = "slips of one symbol or reference"


@dataclass(frozen=True, slots=True, kw_only=True)
class Cause:
    """One error of the paper.

    Parameters
    ----------
    name : str
        A few words, unique.
    weight : Weight
    printed, right : str
        What the paper says and what it should say.
    changes : str
        What follows for numbers, figures and conclusions.
    claims : sequence of str
        Labels of the claims that are wrong for this reason; one may have two reasons.
    """

    name: str
    weight: Weight
    printed: str
    right: str
    changes: str
    claims: Sequence[str]


def _causes(weight: Weight, *rows: tuple[str, str, str, str, tuple[str, ...]]) -> tuple[Cause, ...]:
    return tuple(
        Cause(name=name, weight=weight, printed=printed, right=right, changes=changes, claims=claims)
        for name, printed, right, changes, claims in rows
    )


_SUBSTANTIAL = _causes(
    Weight.SUBSTANTIAL,
    (
        "mass",
        "m = 0.043 kg",
        "m = 0.070 kg, with which the printed A and C give the printed a and c",
        "the printed mass and moments are those of a can with a = 1.184 and c = 1.001, which would "
        "turn by 203 degrees and ask for a friction of 0.439; the results printed are of the groups",
        ("text:m",),
    ),
    (
        "units of eps and zeta",
        "eps = 1.43e-10, zeta = 0.40",
        "eps = B_-2^2 = 3.76e-11, zeta = 0.669, in the time of (2.13) that (4.17)-(4.22) use",
        "eps is (a_p + 1) B_-2^2, with B_-2 in rescaled time, for which a_3 = a_p would be "
        "a_p/(a_p + 1); phi_min from it is 8.1e-5 where the motion has 4.2e-5; figures of (4.22) "
        "drawn with it show another bounce",
        ("text:eps", "text:zeta"),
    ),
    (
        "unit of the release",
        "psi' = 0.1001, theta' = -0.1000 with dots for scaled time",
        "both are in rad/s: 0.006148 and -0.006141 in scaled time",
        "inserted into (2.13) as printed they give another motion, with a peak rate sixteen times "
        "smaller",
        ("text:unit of the release",),
    ),
    (
        "exchanged peaks",
        "numerical peak 3575, by (5.17) 3449, an error of 3.5 %",
        "numerical peak 3449, by (5.17) 3575 (in sqrt(g/R)), an error of 3.7 %",
        "(5.17) overestimates the rate, where the paper says it underestimates it",
        ("text:numerical peak", "text:predicted peak", "text:error of the peak"),
    ),
    (
        "height of the cylinder",
        "height H; A = m (3 R^2 + H^2)/12",
        "height 2H, as section 2 and h = 1.473 have it; A = m (3 R^2 + 4 H^2)/12",
        "the friction of a uniform cylinder is 12 h/(3 + 16 h^2), at most 0.866 at h = 0.433, and "
        "not 0.96 at 0.48",
        (
            "text:height of the can",
            "text:uniform cylinder",
            "text:largest friction",
            "text:height of largest friction",
        ),
    ),
    (
        "friction at small a_p",
        "a small a_p results in a large coefficient of friction, so large turns cannot be seen",
        "h/a_p <= 1/sqrt(a_p), and it vanishes with h: thin disks have both a small a_p and little "
        "friction",
        "the explanation why large turns are not seen fails: a thin uniform disk turns by 402 "
        "degrees and needs next to no friction",
        ("text:small a_p and friction",),
    ),
    (
        "logarithm of Theta + Psi",
        "Theta + Psi = O(1), in proportion to B_0",
        "Theta + Psi = (1 - h^2 k)/c_p B_-2 log phi + O(1)",
        "B_0 is not in proportion to the momentum about the body's axis, which friction changes by "
        "more than itself between release and bounce (from 1.9e-6 to -5.3e-6, even in sign); only "
        "H_z^B - H_z^G is kept, as B_-2 is",
        (
            "text:growth of the sum",
            "text:F_y in proportion",
            "text:sum in proportion",
            "text:B_0 as momentum",
            "text:effect of friction",
        ),
    ),
    (
        "large eps in panels c) and d)",
        "the wobbles of c) and the cusps of d) come with a large eps",
        "eps = 2.4e-9 and 5.2e-13: small; it is B_0 that is large, zeta = 1.9e3 and 1.4e5",
        "the reading of the figure is the reverse in d): on the boundary (6.4) eps vanishes; both "
        "lie outside the assumption zeta = O(1)",
        ("text:panel c", "text:panel d"),
    ),
    (
        "stability of straight rolling",
        "h (h + c_p) in the eigenvalues and in Theta_crit",
        "c_p + h^2",
        "Theta_crit of the paper's can is 1.090 and not 0.994 sqrt(g/R); for a thin disk it is "
        "finite and not infinite",
        ("eq01:eigenvalues", "text:critical rate", "text:centre-like"),
    ),
    (
        "balanced rolling",
        "c Theta in the condition for S_bal",
        "(c_p + h^2) Theta",
        "Theta_e of a balanced can that spins is six times smaller for the paper's can",
        ("eq01:bal_eqm", "text:balanced Theta"),
    ),
    (
        "sign in S_rest",
        "a sin phi cos phi + c h sin^2 phi",
        "a sin phi cos phi - c h sin^2 phi",
        "Psi_e is another, and S_rest exists again beyond arctan(a/(c h)) for a > c",
        ("text:S_rest", "text:range of S_rest"),
    ),
    (
        "sense of the locus",
        "y_l = +sin(...), clockwise for B_-2 > 0",
        "y_l = -sin(...), anticlockwise for B_-2 > 0",
        "every statement on the sense of the contact locus is reversed",
        ("eq01:contact_pt_inner", "eq01:contact_pt_outer", "text:sense of the locus"),
    ),
    (
        "series that suffice",
        "the reduced equation follows from the series (4.14)",
        "from series up to phi^2, with the logarithms",
        "with (4.14) a_1, a_l0 and a_0 come out wrong; those that appendix D lists need the "
        "terms that (4.14) drops",
        ("text:series suffice",),
    ),
)

_FORMULA = _causes(
    Weight.FORMULA,
    (
        "angle in the bounce",
        "sqrt(a_p+1)/a_p arctan",
        "sqrt((a_p+1)/a_p) arctan",
        "the jump of psi as printed is not the angle of turn (6.1)",
        ("eq01:psi_inner", "eq01:theta_inner", "eq01:contact_pt_inner"),
    ),
    (
        "angle before the bounce",
        "arctanh(t/sqrt(I))",
        "I^(-3/2) arctanh(t/sqrt(I))",
        "psi in the outer region",
        ("text:outer psi", "eq01:contact_pt_outer"),
    ),
    (
        "rho of the exact solution",
        "rho = (9 + 4 gamma + 4 i beta)/16",
        "rho = (9 - 4 gamma - 4 i beta)/16",
        "the hypergeometric functions as printed do not solve (4.2)",
        ("eq01:hyper_geom",),
    ),
    (
        "M in the acceleration",
        "x'' = L cos psi + M sin psi",
        "x'' = L cos psi - M sin psi",
        "the direction of the friction, not its size: |F| needs the right sign too",
        ("eq01:lin_eom", "eq01:fx"),
    ),
    (
        "order of the rotations",
        "R_GB = R_GI R_IB",
        "R_GB = R_IB R_GI",
        "the moment in (2.3), if the product is taken as printed",
        ("text:R_GB",),
    ),
    (
        "sense of the nutation",
        "rotation by phi about y^I",
        "rotation by -phi",
        "figure and text only: (2.1) and the equations use -phi",
        ("text:sense of the nutation",),
    ),
    (
        "pendulum",
        "phi(t) = phi* +- integral over s from the scaled time",
        "the time is the integral over the angle; time scale (h^2+1)^(1/4)/sqrt(a_p+1)",
        "(2.19) only",
        ("text:pendulum solution",),
    ),
    (
        "series of Theta",
        "(4 c_p + 3) B_-2",
        "(3 c_p + 3) B_-2",
        "(4.13); appendix A has it right",
        ("eq01:theta_orig",),
    ),
    (
        "logarithms of Psi",
        "Psi_l0 and Psi_l1 with a plus",
        "with a minus, as in (4.12)",
        "(4.14b) with the coefficients of appendix A",
        ("app:Psi_l0", "app:Psi_l1", "eq01:psi_series", "eq01:series_sols"),
    ),
    (
        "a_0",
        "the coefficient a_0 of appendix D, with a B without a subscript",
        "the form given below",
        "the least term of (4.22)",
        ("app:a_0",),
    ),
    (
        "remainder of the reduced equation",
        "O(phi log phi)",
        "O(phi (log phi)^2)",
        "what (4.22) neglects",
        ("eq01:Phi_reduced_intermediate",),
    ),
    (
        "remainder in the bounce",
        "O(log eps)",
        "O(eps log eps)",
        "the bound as printed exceeds the terms kept",
        ("text:inner precession",),
    ),
    (
        "logarithms in the matching",
        "corrections of order eps^(1/2), remainder O(eps)",
        "of order eps^(1/2) log eps, remainder O(eps (log eps)^2)",
        "the matched solution is less exact than stated, by the square of a logarithm",
        ("text:inner ansatz", "text:order of the composite"),
    ),
    (
        "outer solution in inner variables",
        "I^(5/2), remainder O(eps^(3/2))",
        "I^(3/2), remainder O(eps (log eps)^2)",
        "P and Q stand, as the leading terms match",
        ("text:outer in inner",),
    ),
    (
        "singular integrals",
        "J_1 and J_3 become singular",
        "J_2, J_3 and J_l2",
        "why the outer solution fails",
        ("text:singular J",),
    ),
    (
        "outer region",
        "phi >> 1",
        "phi >> eps^(1/2)",
        "where the outer solution holds: phi is at most pi/100 in the paper's motion",
        ("text:outer region", "text:regular perturbation"),
    ),
    (
        "both sides of the bounce",
        "the inner solution is only valid for T < 0",
        "it is valid for T > 0 too",
        "none: the symmetry gives the same turn",
        ("text:inner valid for T<0",),
    ),
    (
        "constants of integration",
        "J_l2, J_l1 and J_ll as listed, with phi_1(0) = 0",
        "each less its value at 0",
        "phi_1(0) as printed is not 0",
        ("app:J_l2", "app:J_l1", "app:J_ll", "eq01:outer_sol", "eq01:outer_solution"),
    ),
    (
        "sign of J_3",
        "T^2/(8 T^2 - 8)",
        "T^2/(8 - 8 T^2)",
        "the strongest singularity of phi_1",
        ("app:J_3", "eq01:outer_sol", "eq01:outer_solution"),
    ),
    (
        "Hamiltonian",
        "four slips: a_ll for a_l1, a factor phi, the term a_1 log phi, two signs",
        "the form given below",
        "(E.2) does not follow from (E.1), and contours drawn from (E.1) are not trajectories",
        ("eq01:hamiltonian1", "eqA:ham1"),
    ),
    (
        "sign of the tangential friction",
        "F_y = +m g k Phi (...)",
        "F_y = -m g k Phi (...)",
        "the sense of the moment in appendix C",
        ("eq01:friction_tangential",),
    ),
    (
        "nutation without friction",
        "psi' (A - C) sin phi cos phi",
        "psi'^2 (A - C) sin phi cos phi",
        "(B.6) only: (B.7) is right",
        ("app:phi equation",),
    ),
    (
        "expansion without friction",
        "expanding in eps",
        "expanding in phi",
        "(B.7) is exact in eps and holds for small phi",
        ("text:expanding in eps",),
    ),
    (
        "momentum about the vertical",
        "H_z^G is a combination of momenta about two axes",
        "it is the momentum about the vertical",
        "none: appendix C says so",
        ("text:H_z^G as momentum",),
    ),
    (
        "lines of action",
        "N intersects z^G",
        "N is parallel to z^G",
        "none: it has no moment about it",
        ("caption:fig01:conserved_quantity_diagram",),
    ),
)

_TYPOGRAPHICAL = _causes(
    Weight.TYPOGRAPHICAL,
    (
        "parenthesis",
        "-cos psi (phi' (...) - sin psi (...)",
        "-cos psi (phi' (...)) - sin psi (...)",
        "none: (2.6) and (3.9) follow from the right form",
        ("eq01:com_velocity", "eq01:non_dimensionalised_com"),
    ),
    (
        "c_p",
        "c_p = 1.6156",
        "c_p = 1.615, as c + 1 (1.6146 with c unrounded)",
        "none",
        ("text:c_p of the can", "eq01:material_parameters"),
    ),
    ("Phi for Psi", "c (Theta + Phi)", "c (Theta + Psi)", "none", ("eq01:ang_mom_B",)),
    ("h for E", "sqrt(h - phi)", "sqrt(E - phi)", "none", ("text:T at eps=0",)),
    ("Psi_2 for Psi_-2", "Psi_2", "Psi_-2", "none", ("text:subscript in (4.16)",)),
    ("index of sums", "sums over n", "over i", "none", ("text:index of the sums",)),
    (
        "integral J_0",
        "every integral is evaluated in appendix G",
        "J_0 = T^2/2 is missing there",
        "none",
        ("text:every integral",),
    ),
    (
        "cross-references",
        "S_bal of (3.6), the Hamiltonian (E.5), panel d) of fig01:contact_locus, (4.21) for (4.19)",
        "S_bal of (3.3), the Hamiltonian (E.1), panel d) of fig01:contact_pt_motion, (4.19)",
        "none",
        (
            "text:reference to S_bal",
            "caption:fig01:hamiltonian_3D",
            "text:reference to panel d",
            "text:bookmarks",
        ),
    ),
    ("axes", "x_p, y_p", "x_l, y_l", "none", ("caption:axes of the locus",)),
)

CAUSES = _SUBSTANTIAL + _FORMULA + _TYPOGRAPHICAL


def causes_of(label: str) -> tuple[str, ...]:
    """Return the names of the errors for which a claim is wrong.

    Parameters
    ----------
    label : str
        Of the claim.
    """
    return tuple(cause.name for cause in CAUSES if label in cause.claims)
