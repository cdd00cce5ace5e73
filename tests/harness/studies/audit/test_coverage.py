"""Every number and every numbered equation of the paper has a row, and every wrong row a cause."""

import csv
from pathlib import Path

import pytest

from harness.paper.audit.causes import CAUSES
from harness.paper.audit.labels import DEFINED_IN, NEAR, NUMBERS, UNLABELLED, place
from harness.paper.audit.run import claims
from harness.paper.audit.source import literals, numbered_rows, numbers_of_labels

PAPER = Path(__file__).parents[5] / "shared" / "paper" / "rocking-can.tex"
BESIDE = pytest.mark.skipif(not PAPER.exists(), reason="the paper's source is not at hand")
with (Path(__file__).parent / "literals.csv").open(encoding="utf-8") as _file:
    LITERALS = tuple(csv.DictReader(_file))
ROWS = {claim.label for claim in claims()}

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


def test_every_numbered_equation_has_a_row() -> None:
    assert set(NUMBERS) <= ROWS
    assert set(UNLABELLED.values()) <= ROWS


def test_every_claim_says_where_it_stands() -> None:
    assert {label for label in ROWS if not place(label)} == set()
    assert not set(NEAR) - ROWS
    assert not set(NEAR) & set(NUMBERS)


@BESIDE
def test_the_committed_numbers_are_the_papers() -> None:
    tex = PAPER.read_text(encoding="utf-8")
    assert [(x["number"], x["quotation"]) for x in LITERALS] == literals(tex)
    numbers = numbers_of_labels(tex)
    assert {"eq01:hamiltonian1": "(E.1)"} | numbers == NUMBERS
    for number, _ in numbered_rows(tex):
        group = f"{number[:-2]})" if number[-2].isalpha() else number
        assert {number, group} & (set(numbers.values()) | set(UNLABELLED)), number


@BESIDE
@pytest.mark.parametrize(
    ("name", "written"),
    [
        ("S_bal", r"S_\text{bal} :="),
        ("S_steady", r"S_\text{steady} ="),
        ("S_static", r"S_\text{static} :="),
    ],
)
def test_what_is_referred_to_is_defined_there(name: str, written: str) -> None:
    tex = PAPER.read_text(encoding="utf-8")
    row = next(row for number, row in numbered_rows(tex) if number == NUMBERS[DEFINED_IN[name]])
    assert written in row


def test_causes_name_claims_of_the_audit() -> None:
    assert {label for cause in CAUSES for label in cause.claims} <= ROWS
    assert len({cause.name for cause in CAUSES}) == len(CAUSES)
    weights = [cause.weight for cause in CAUSES]
    assert weights == sorted(weights, key=list(type(weights[0])).index)
