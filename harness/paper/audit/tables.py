"""The audit as a table and as a page of Markdown."""

from collections.abc import Sequence
from itertools import groupby

from harness.core.report_model import Column, Prose, Table, table_of
from harness.paper.audit.claims import (
    ERRORS,
    MEANINGS,
    WRONG,
    AuditRow,
    ClaimStatus,
    PaperError,
    Weight,
)

COLUMNS = (
    Column(
        name="label",
        meaning="The paper's label; text:, caption: and app: name claims without one",
        value="claim.label",
    ),
    Column(name="section", meaning="Section or appendix of the paper", value="claim.section"),
    Column(
        name="place",
        meaning="Number of the equation in print, or where the statement stands",
        value="claim.place",
    ),
    Column(name="says", meaning="The claim in a few words", value="claim.says"),
    Column(name="printed", meaning="The claim as printed, in LaTeX", value="claim.printed"),
    Column(name="verdict", meaning="How it stands", value="status.value"),
    Column(
        name="errors",
        meaning="The errors for which it is wrong, several claims may share one",
        value=lambda row: "; ".join(row.claim.errors),
    ),
    Column(name="correct", meaning="The right form or number, where it is another"),
    Column(name="how", meaning="How it was checked, with what decided", value="ruling.how"),
    Column(
        name="check",
        meaning="The function that computed the verdict, under harness/paper/audit/checks",
    ),
)
PAPER = "Collins, Hall and Hogan, *The rocking can*, arXiv:2302.08335"


def audit_table(rows: Sequence[AuditRow]) -> Table:
    """Return the audit as a table, a row each, in the order of the paper."""
    return table_of("audit", "Audit of the paper", COLUMNS, rows)


def counts(rows: Sequence[AuditRow]) -> dict[ClaimStatus, int]:
    """Return how many claims have each verdict."""
    return {status: sum(row.status is status for row in rows) for status in ClaimStatus}


def errors(rows: Sequence[AuditRow]) -> list[PaperError]:
    """Return the errors that the wrong claims come down to, gravest first."""
    named = {name for row in rows for name in row.claim.errors}
    return [error for error in ERRORS if error.name in named]


def audit_words(rows: Sequence[AuditRow]) -> Prose:
    """Return how many claims stand, and how many errors there are."""
    numbers = ", ".join(f"{n} {status.value}" for status, n in counts(rows).items() if n)
    wrong = [row for row in rows if row.status in WRONG]
    first = f"Of {len(rows)} claims of the paper: {numbers}."
    second = f"The first that is wrong is {wrong[0].claim.label}." if wrong else "None is wrong."
    return Prose(name="summary", title="Summary", text=f"{first} {second} {_weighed(rows)}")


def _weighed(rows: Sequence[AuditRow]) -> str:
    """Return how many errors of each weight there are, in one sentence."""
    listed = errors(rows)
    if not listed:
        return ""
    wrong = sum(row.status in WRONG for row in rows)
    parts = []
    for weight in Weight:
        number = sum(error.weight is weight for error in listed)
        if number:
            parts.append(f"{number} {weight.heading}")
    return f"The {wrong} wrong claims come down to {len(listed)} errors: {', '.join(parts)}."


METHOD = """\
The checks know nothing of the paper's derivations: the equations of motion are derived again from
a rotation, the contact and Newton's laws; series by recurrence; integrals by quadrature; numbers
from the exact motion of the paper's release (g = 9.81 m/s^2). An expression is compared at random
points to forty digits and, where it agrees, symbolically; a stated order by the rate at which the
remainder falls; a number by rounding. Every check is tried on altered claims, which it has to
refuse, and on the right one, which it has to accept. A result holds
where it is right as printed, even if a formula on the way to it is wrong: that has its own row.
The LaTeX quoted in a row and the form that its check computes with were put side by side by
reading: the quotation is compared with the paper's source, and the form is altered to try the
check, but nothing derives the one from the other.

Each number of text and captions, each numbered equation and each list of coefficients has a row,
and so have the statements about where a formula holds, what follows from what, and what the figures
show. Equations have their numbers in print, figures their LaTeX labels; rows stand in the order of
the paper. What is printed is quoted from the LaTeX source; in words B_-2 stands for $B_{-2}$, phi'
for a derivative in time, varphi for the inner variable.
"""


def markdown(rows: Sequence[AuditRow]) -> str:
    """Return the audit as a page: verdicts counted, the errors by weight, then every claim.

    Parameters
    ----------
    rows : sequence of AuditRow
    """
    numbers = counts(rows)
    lines = [
        "# Audit of the paper",
        "",
        f"What {PAPER}, states, checked by computation. {_weighed(rows)}".rstrip(),
        "Written by `rockingcan audit`; each verdict is computed by the check named beside it.",
        "",
        METHOD,
        "| verdict | claims | meaning |",
        "|---|---:|---|",
        *(f"| {x.value} | {numbers[x]} | {MEANINGS[x]} |" for x in ClaimStatus),
        f"| all | {len(rows)} | |",
    ]
    lines += _errors(rows)
    for section, members in groupby(rows, key=lambda row: row.claim.section):
        lines += ["", f"## {_heading(section)}", ""]
        lines += [
            "| label | place | claim | printed | verdict | correct | how it was checked | check |",
            "|---|---|---|---|---|---|---|---|",
        ]
        lines += [
            _row(
                row.claim.label,
                row.claim.place,
                row.claim.says,
                f"`{row.claim.printed}`",
                row.status.value,
                row.correct,
                row.ruling.how,
                f"`{row.check}`",
            )
            for row in members
        ]
    return "\n".join(lines) + "\n"


def _errors(rows: Sequence[AuditRow]) -> list[str]:
    """Return the errors as tables, one of each weight."""
    listed = errors(rows)
    lines: list[str] = []
    for weight in Weight:
        of_weight = [error for error in listed if error.weight is weight]
        if not of_weight:
            continue
        lines += ["", f"## {weight.heading.capitalize()}", ""]
        lines += [
            "| | error | where | printed | right | what it changes | rows |",
            "|---:|---|---|---|---|---|---|",
        ]
        for error in of_weight:
            claims = [row.claim for row in rows if error.name in row.claim.errors]
            where = dict.fromkeys(f"{_heading(claim.section)}, {claim.place}" for claim in claims)
            lines.append(
                _row(
                    str(listed.index(error) + 1),
                    error.name,
                    "; ".join(where),
                    error.printed,
                    error.right,
                    error.changes,
                    "; ".join(claim.label for claim in claims),
                )
            )
    return lines


def _heading(section: str) -> str:
    return f"Section {section}" if section[0].isdigit() else f"Appendix {section}"


def _row(*cells: str) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |"
