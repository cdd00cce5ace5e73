"""The audit covers the paper, and finds what is independently known."""

import pytest

from harness.paper.audit import CLAIMS, AuditRow, ClaimStatus, audit_table, checks, counts, markdown
from harness.paper.audit.claims import ERRORS, WRONG, Weight, symbols_apart
from harness.paper.audit.evidence import CHECKS, audit, check, name_of


@pytest.fixture(scope="module")
def rows() -> tuple[AuditRow, ...]:
    return tuple(audit())


@pytest.fixture(scope="module")
def verdicts(rows: tuple[AuditRow, ...]) -> dict[str, ClaimStatus]:
    return {row.claim.label: row.status for row in rows}


def test_every_claim_has_a_check_and_every_check_a_claim() -> None:
    assert {claim.label for claim in CLAIMS} == set(CHECKS)
    assert len({claim.label for claim in CLAIMS}) == len(CLAIMS)


def test_every_check_is_named_after_its_file() -> None:
    files = {name for name in vars(checks) if not name.startswith("_")} - {"audit"}
    named = [name_of(claim.label).split(".") for claim in CLAIMS]
    assert {file for file, _ in named} <= files
    assert all(function.isidentifier() for _, function in named)


def test_a_claim_has_one_check() -> None:
    with pytest.raises(ValueError, match="two checks"):
        check("eq01:Psi")(CHECKS["eq01:Psi"])


@pytest.mark.slow
def test_the_equations_of_motion_hold(verdicts: dict[str, ClaimStatus]) -> None:
    """They are derived from Newton-Euler in tests/reference too, by other means."""
    for label in ("eq01:non_dimensionalised_eom", "eq01:raw_eom", "eq01:frob_ode", "eq01:Phi"):
        assert verdicts[label] is ClaimStatus.HOLDS


@pytest.mark.slow
@pytest.mark.parametrize(
    "label",
    [
        "eq01:fx",
        "eq01:bal_eqm",
        "eq01:eigenvalues",
        "eq01:hyper_geom",
        "eq01:theta_orig",
        "eq01:friction_tangential",
        "eq01:psi_inner",
        "eq01:hamiltonian1",
        "app:a_0",
        "app:J_3",
        "text:uniform cylinder",
    ],
)
def test_errors_that_another_derivation_found_too(
    verdicts: dict[str, ClaimStatus], label: str
) -> None:
    """`reference` uses the right forms of these, and its docstrings say so."""
    assert verdicts[label] in {ClaimStatus.MISPRINT, ClaimStatus.FALSE}


@pytest.mark.slow
def test_one_wrong_mass_is_one_defect(verdicts: dict[str, ClaimStatus]) -> None:
    fitting = ("text:A", "text:C", "text:a of the can", "text:c of the can")
    assert all(verdicts[x] is ClaimStatus.HOLDS for x in fitting)
    assert verdicts["text:m"] is ClaimStatus.INCONSISTENT


@pytest.mark.slow
@pytest.mark.parametrize("label", ["app:J_l2", "app:J_l1", "app:J_ll", "app:J_1"])
def test_a_double_integral_may_have_any_constants(
    verdicts: dict[str, ClaimStatus], label: str
) -> None:
    """That phi_1(0) = 0 asks for some is a matter of (5.6)."""
    assert verdicts[label] is ClaimStatus.HOLDS
    assert verdicts["eq01:outer_solution"] is ClaimStatus.FALSE


@pytest.mark.slow
@pytest.mark.parametrize(
    "label",
    [
        "eqA:ham1",
        "eq01:series_sols",
        "eq01:psi_series",
        "eq01:outer_solution",
        "text:centre-like",
        "eq01:initial_conditions",
        "eq01:material_parameters",
        "eq01:simultaneous",
        "eq01:outer_sol",
    ],
)
def test_what_holds_only_when_mended_does_not_hold(
    verdicts: dict[str, ClaimStatus], label: str
) -> None:
    assert verdicts[label] in WRONG


@pytest.mark.slow
@pytest.mark.parametrize(
    "label",
    [
        "text:balanced at rest",  # a condition, which the paper's can never meets
        "text:lying and rolling",  # the paper speaks of its own can
        "text:momenta in short",  # related to is not in proportion to
        "text:effect of friction",  # small, if not beside the momenta
    ],
)
def test_what_is_true_as_printed_is_not_called_false(
    verdicts: dict[str, ClaimStatus], label: str
) -> None:
    assert verdicts[label] is ClaimStatus.HOLDS


@pytest.mark.slow
@pytest.mark.parametrize("label", ["eq01:Phi_reduced_intermediate", "eq01:Phi_reduced", "app:a_0"])
def test_an_equation_with_the_printed_a_0_is_false(
    verdicts: dict[str, ClaimStatus], label: str
) -> None:
    assert verdicts[label] is ClaimStatus.FALSE


@pytest.mark.slow
def test_a_misprint_is_one_symbol_away_and_nothing_else_is(rows: tuple[AuditRow, ...]) -> None:
    for row in rows:
        claim = row.claim
        one = bool(claim.right) and symbols_apart(claim.printed, claim.right) == 1
        assert (row.status is ClaimStatus.MISPRINT) == one, claim.label


@pytest.mark.parametrize(
    ("one", "other", "apart"),
    [
        (r"L\cos\psi + M", r"L\cos\psi - M", 1),
        (r"\frac{\sqrt{a}}{a}", r"\frac{\sqrt{a}}{\sqrt{a}}", 1),
        (r"\dpsi(A - C)", r"\dpsi^2(A - C)", 1),
        (r"\cref{eq01:a}", r"\cref{fig01:b}", 1),
        ("(4.21)", "(4.19)", 1),
        ("1.6156", "1.615", 1),
        ("9 + 4i", "9 + 4i", 0),
        (r"\mat{R}\mat{S}", r"\mat{S}\mat{R}", 2),
        ("clockwise", "anticlockwise", 4),
    ],
)
def test_symbols_are_counted(one: str, other: str, apart: int) -> None:
    assert symbols_apart(one, other) == symbols_apart(other, one) == apart


@pytest.mark.slow
def test_whatever_is_wrong_comes_with_what_is_right(rows: tuple[AuditRow, ...]) -> None:
    for row in rows:
        assert row.ruling.how, row.claim.label
        assert bool(row.correct) == (row.status in WRONG), row.claim.label


@pytest.mark.slow
def test_the_page_and_the_table_tell_the_same(rows: tuple[AuditRow, ...]) -> None:
    page, table = markdown(rows), audit_table(rows)
    assert len(table.frame) == len(rows)
    assert set(table.columns) == set(table.frame.columns)
    for verdict, number in counts(rows).items():
        assert f"| {verdict.value} | {number} |" in page
    for claim in CLAIMS:
        assert f"| {claim.label} |" in page


@pytest.mark.slow
def test_whatever_is_wrong_has_an_error_and_an_error_is_of_what_is_wrong(
    rows: tuple[AuditRow, ...],
) -> None:
    assert {row.claim.label for row in rows if row.status in WRONG} == {
        claim.label for claim in CLAIMS if claim.errors
    }


@pytest.mark.slow
def test_slips_of_one_symbol_are_misprints(rows: tuple[AuditRow, ...]) -> None:
    slips = {error.name for error in ERRORS if error.weight is Weight.TYPOGRAPHICAL}
    for row in rows:
        if row.claim.errors and set(row.claim.errors) <= slips:
            assert row.status is ClaimStatus.MISPRINT, row.claim.label


@pytest.mark.slow
@pytest.mark.parametrize(
    "label", ["eq01:inner_solution", "text:inner ansatz", "eq01:uniformly_valid_solution"]
)
def test_the_remainders_of_inner_and_matched_solution_agree(
    verdicts: dict[str, ClaimStatus], label: str
) -> None:
    """What the inner solution leaves out by its matching, (5.14) leaves out too."""
    assert verdicts[label] in WRONG


@pytest.mark.slow
def test_the_page_begins_with_the_errors(rows: tuple[AuditRow, ...]) -> None:
    page = markdown(rows)
    places = [page.index(weight.heading.capitalize()) for weight in Weight]
    assert places == sorted(places)
    assert places[-1] < page.index("## Section 1")
    assert f"come down to {len(ERRORS)} errors" in page
    for error in ERRORS:
        assert f"| {error.name} |" in page
