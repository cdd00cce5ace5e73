"""Every number and every numbered equation of the paper has a row, quoted word for word."""

import csv
import re
from pathlib import Path

import pytest

from harness.paper.audit import CLAIMS
from harness.paper.audit.checks.references import DEFINED_IN
from harness.paper.audit.claims import ERRORS, Claim
from tests.harness.paper.audit.source import folded, literals, numbered_rows, numbers_of_labels

PAPER = Path(__file__).parents[5] / "shared" / "paper" / "rocking-can.tex"
BESIDE = pytest.mark.skipif(not PAPER.exists(), reason="the paper's source is not at hand")
with (Path(__file__).parent / "literals.csv").open(encoding="utf-8") as _file:
    LITERALS = tuple(csv.DictReader(_file))
CLAIM = {claim.label: claim for claim in CLAIMS}
ROWS = set(CLAIM)

TOY = r"""
\newcommand{\no}{7}
\begin{document}
\section{One}\label{s}
A turn of $\pm217^\circ$ % not 218
and $\epsilon=1.5\times 10^{-3}$, $x_2^3$ \cite{Smith2008} at $t=0$.
\begin{align}
 a &= 42 \label{eq:a}\\
 &+ \begin{pmatrix} 1 \\ 2 \end{pmatrix} \nonumber\\
 b &= 1
\end{align}
\begin{subequations}\label{eq:group}
\begin{align}
 c &= 1\\ d &= 2 \label{eq:d}
\end{align}
\end{subequations}
\begin{align*} e \end{align*}
\appendix
\section{Two}
\begin{equation}\label{eq:f} f \end{equation}
\put(15,50){a}
\caption{A mass of \SI{4.3e-2}{kg}.}
"""


def test_equations_are_numbered_as_latex_does() -> None:
    assert numbers_of_labels(TOY) == {
        "eq:a": "(1.1)",
        "eq:group": "(1.3)",
        "eq:d": "(1.3b)",
        "eq:f": "(A.1)",
    }
    assert [number for number, _ in numbered_rows(TOY)] == [
        "(1.1)",
        "(1.2)",
        "(1.3)",
        "(1.3a)",
        "(1.3b)",
        "(A.1)",
    ]


def test_numbers_of_text_and_captions_are_found() -> None:
    found = literals(TOY)
    assert [number for number, _ in found] == ["217", "1.5e-3", "4.3e-2"]
    assert "A turn of" in found[0][1]


def test_every_number_of_the_paper_has_a_row_or_a_reason() -> None:
    for literal in LITERALS:
        assert literal["number"] in literal["quotation"]
        assert bool(literal["row"]) != bool(literal["reason"]), literal
        assert not literal["row"] or literal["row"] in ROWS, literal


def test_every_claim_says_where_it_stands_and_what_is_printed() -> None:
    for claim in CLAIMS:
        assert claim.place, claim.label
        assert claim.says, claim.label
        assert claim.printed == folded(claim.printed), claim.label
        assert claim.right != claim.printed, claim.label


@BESIDE
@pytest.mark.parametrize("claim", CLAIMS, ids=[claim.label for claim in CLAIMS])
def test_what_is_printed_is_quoted_word_for_word(claim: Claim) -> None:
    assert claim.printed in folded(PAPER.read_text(encoding="utf-8"))


@BESIDE
def test_the_committed_numbers_are_the_papers() -> None:
    tex = PAPER.read_text(encoding="utf-8")
    assert [(x["number"], x["quotation"]) for x in LITERALS] == literals(tex)


@BESIDE
def test_every_labelled_equation_has_a_row_with_its_number() -> None:
    numbers = numbers_of_labels(PAPER.read_text(encoding="utf-8"))
    # its label stands in a row without a number, below the row with this one
    numbers["eq01:hamiltonian1"] = "(E.1)"
    # of a pair of equations each has a row of its own
    numbers["eq01:simultaneous"] = "(4.16a)"
    assert {label: CLAIM[label].place for label in numbers} == numbers


@BESIDE
def test_every_numbered_equation_has_a_row() -> None:
    """A row before or after an equation, or in a footnote at it, is not the equation's."""
    number = r"\(\w\.\w+\)"
    of_equations = [x for x in CLAIMS if re.fullmatch(rf"{number}(, {number})*", x.place)]
    assert not [claim.label for claim in of_equations if r"\begin{align}" in claim.printed]
    places = {found for claim in of_equations for found in re.findall(number, claim.place)}
    for printed, _ in numbered_rows(PAPER.read_text(encoding="utf-8")):
        # a letter belongs to a group that may have one row
        group = f"{printed[:-2]})" if printed[-2].isalpha() else printed
        letters = {place for place in places if place[-2].isalpha() and place[:-2] == group[:-1]}
        assert {printed, group} & places or (printed == group and letters), printed


@BESIDE
@pytest.mark.parametrize(("name", "written"), [("S_bal", r"S_\text{bal} :=")])
def test_what_is_referred_to_is_defined_there(name: str, written: str) -> None:
    tex = PAPER.read_text(encoding="utf-8")
    place = CLAIM[DEFINED_IN[name]].place
    assert written in next(row for number, row in numbered_rows(tex) if number == place)


def test_claims_name_errors_of_the_audit() -> None:
    named = {name for claim in CLAIMS for name in claim.errors}
    assert named == {error.name for error in ERRORS}
    assert len(named) == len(ERRORS)
    weights = [error.weight for error in ERRORS]
    assert weights == sorted(weights, key=list(type(weights[0])).index)


def test_the_report_has_a_row_for_each_claim() -> None:
    with (Path(__file__).parents[4] / "reports" / "audit.csv").open(encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == len(CLAIMS)
