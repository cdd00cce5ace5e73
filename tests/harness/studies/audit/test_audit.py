"""The audit covers the paper, and finds what is independently known."""

import re
from pathlib import Path

import pytest

from harness.paper.audit import checks
from harness.paper.audit.causes import CAUSES, Weight
from harness.paper.audit.finding import WRONG, AuditRow, ClaimStatus
from harness.paper.audit.labels import LABELS
from harness.paper.audit.registry import claim
from harness.paper.audit.run import audit, claims
from harness.paper.audit.tables import audit_table, counts, markdown

PAPER = Path(__file__).parents[5] / "shared" / "paper" / "rocking-can.tex"


@pytest.fixture(scope="module")
def findings() -> tuple[AuditRow, ...]:
    return tuple(audit())


@pytest.fixture(scope="module")
def verdicts(findings: tuple[AuditRow, ...]) -> dict[str, ClaimStatus]:
    return {finding.label: finding.ruling.verdict for finding in findings}


def test_every_label_has_a_check() -> None:
    assert not set(LABELS) - {c.label for c in claims()}


@pytest.mark.skipif(not PAPER.exists(), reason="the paper's source is not beside the repository")
def test_the_list_of_labels_is_the_papers() -> None:
    found = re.findall(r"\\label\{((?:eq|app01:Phi)[^}]*)\}", PAPER.read_text(encoding="utf-8"))
    assert tuple(found) == LABELS


def test_every_check_is_named_after_its_file() -> None:
    files = {path.stem for path in Path(checks.__path__[0]).glob("*.py")} - {"__init__"}
    named = {c.name.split(".")[0] for c in claims()}
    assert named == files
    assert all(c.name.split(".")[1].isidentifier() for c in claims())


def test_a_claim_has_one_check() -> None:
    with pytest.raises(ValueError, match="two checks"):
        claim("eq01:Psi", "2", "again")(claims()[0].check)


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
    assert all(verdicts[x] is ClaimStatus.HOLDS for x in (*fitting, "eq01:material_parameters"))
    assert verdicts["text:m"] is ClaimStatus.INCONSISTENT


@pytest.mark.slow
@pytest.mark.parametrize(
    "label",
    ["eqA:ham1", "eq01:series_sols", "eq01:psi_series", "eq01:outer_solution", "text:centre-like"],
)
def test_what_holds_only_when_mended_is_false_as_printed(
    verdicts: dict[str, ClaimStatus], label: str
) -> None:
    assert verdicts[label] is ClaimStatus.FALSE


@pytest.mark.slow
@pytest.mark.parametrize(
    "label", ["eq01:com_velocity", "eq01:theta_orig", "eq01:psi_inner", "app:J_3"]
)
def test_one_symbol_away_is_a_misprint(verdicts: dict[str, ClaimStatus], label: str) -> None:
    assert verdicts[label] is ClaimStatus.MISPRINT


@pytest.mark.slow
def test_whatever_is_wrong_comes_with_what_is_right(findings: tuple[AuditRow, ...]) -> None:
    for finding in findings:
        assert finding.ruling.how, finding.label
        assert (finding.ruling.verdict not in WRONG) or finding.ruling.correct, finding.label


@pytest.mark.slow
def test_the_page_and_the_table_tell_the_same(findings: tuple[AuditRow, ...]) -> None:
    page, table = markdown(findings), audit_table(findings)
    assert len(table.frame) == len(findings) == len({f.label for f in findings})
    assert set(table.columns) == set(table.frame.columns)
    for verdict, number in counts(findings).items():
        assert f"| {verdict.value} | {number} |" in page
    for finding in findings:
        assert f"| {finding.label} |" in page


@pytest.mark.slow
def test_whatever_is_wrong_has_a_cause_and_a_cause_is_of_what_is_wrong(
    findings: tuple[AuditRow, ...],
) -> None:
    wrong = {finding.label for finding in findings if finding.ruling.verdict in WRONG}
    assert wrong == {label for cause in CAUSES for label in cause.claims}
    assert wrong == {finding.label for finding in findings if finding.causes}


@pytest.mark.slow
def test_the_page_begins_with_the_errors(findings: tuple[AuditRow, ...]) -> None:
    page = markdown(findings)
    places = [page.index(weight.value.capitalize()) for weight in Weight]
    assert places == sorted(places)
    assert places[-1] < page.index("## Section 1")
    assert f"come down to {len(CAUSES)} errors" in page
    for cause in CAUSES:
        assert f"| {cause.name} |" in page
