"""The audit as a table and as a page of Markdown."""

from collections.abc import Sequence
from itertools import groupby

import pandas as pd

from harness.core.report_model import Prose, Table
from harness.paper.audit.causes import CAUSES, Cause, Weight
from harness.paper.audit.finding import MEANINGS, WRONG, AuditRow, ClaimStatus

COLUMNS = {
    "label": "The paper's label; text:, caption: and app: name claims without one",
    "section": "Section or appendix of the paper",
    "place": "Number of the equation in print, or where the statement stands",
    "says": "The claim",
    "verdict": "How it stands",
    "causes": "The errors for which it is wrong, several claims may share one",
    "correct": "The right form or number, where it is another; or a remark",
    "how": "How it was checked, with what decided",
    "check": "The function that computed the verdict, under harness/paper/audit/checks",
}
PAPER = "Collins, Hall and Hogan, *The rocking can*, arXiv:2302.08335"


def audit_table(findings: Sequence[AuditRow]) -> Table:
    """Return the findings as a table, a row each, in the order of the paper's sections."""
    rows = [
        {
            "label": finding.label,
            "section": finding.section,
            "place": finding.place,
            "says": finding.says,
            "verdict": finding.ruling.verdict.value,
            "causes": "; ".join(finding.causes),
            "correct": finding.ruling.correct,
            "how": finding.ruling.how,
            "check": finding.check,
        }
        for finding in findings
    ]
    return Table(
        name="audit",
        title="Audit of the paper",
        frame=pd.DataFrame(rows, columns=list(COLUMNS)),
        columns=COLUMNS,
        shown=tuple(COLUMNS),
    )


def counts(findings: Sequence[AuditRow]) -> dict[ClaimStatus, int]:
    """Return how many claims have each verdict."""
    return {v: sum(f.ruling.verdict is v for f in findings) for v in ClaimStatus}


def errors(findings: Sequence[AuditRow]) -> list[Cause]:
    """Return the errors that the wrong claims come down to, gravest first."""
    named = {name for finding in findings for name in finding.causes}
    return [cause for cause in CAUSES if cause.name in named]


def audit_words(findings: Sequence[AuditRow]) -> Prose:
    """Return how many claims stand, and how many errors there are."""
    found = counts(findings)
    told = ", ".join(f"{number} {verdict.value}" for verdict, number in found.items() if number)
    wrong = [f for f in findings if f.ruling.verdict in WRONG]
    first = f"Of {len(findings)} claims of the paper: {told}."
    second = f"The first that is wrong is {wrong[0].label}." if wrong else "None is wrong."
    return Prose(name="summary", title="Summary", text=f"{first} {second} {_weighed(findings)}")


def _weighed(findings: Sequence[AuditRow]) -> str:
    """Return how many errors of each weight there are, in one sentence."""
    found = errors(findings)
    if not found:
        return ""
    wrong = sum(bool(finding.causes) for finding in findings)
    parts = []
    for weight in Weight:
        number = sum(cause.weight is weight for cause in found)
        if number:
            parts.append(f"{number} {weight.value}")
    return f"The {wrong} wrong claims come down to {len(found)} errors: {', '.join(parts)}."


METHOD = """\
The checks know nothing of the paper's derivations: the equations of motion are derived again from
a rotation, the contact and Newton's laws; series by recurrence; integrals by quadrature; numbers
from the exact motion of the paper's release (g = 9.81 m/s^2). An expression is compared at random
points to forty digits and, where it agrees, symbolically; a stated order by the rate at which the
remainder falls; a number by rounding. Every check is tried on altered claims, which it has to
refuse.

Each number of text and captions, each numbered equation and each list of coefficients has a row.
Equations have their numbers in print, figures their LaTeX labels. What is printed is quoted in
plain letters: B_-2 stands for $B_{-2}$, phi' for a derivative in time, varphi for the inner
variable.
"""


def markdown(findings: Sequence[AuditRow]) -> str:
    """Return the audit as a page: verdicts counted, the errors by weight, then every claim.

    Parameters
    ----------
    findings : sequence of Finding
    """
    found = counts(findings)
    lines = [
        "# Audit of the paper",
        "",
        f"What {PAPER}, states, checked by computation. {_weighed(findings)}".rstrip(),
        "Written by `rockingcan audit`; each verdict is computed by the check named beside it.",
        "",
        METHOD,
        "| verdict | claims | meaning |",
        "|---|---:|---|",
        *(f"| {v.value} | {found[v]} | {MEANINGS[v]} |" for v in ClaimStatus),
        f"| all | {len(findings)} | |",
    ]
    lines += _errors(findings)
    for section, members in groupby(findings, key=lambda f: f.section):
        lines += ["", f"## {_heading(section)}", ""]
        lines += [
            "| label | place | printed | verdict | correct | how it was checked | check |",
            "|---|---|---|---|---|---|---|",
        ]
        lines += [
            _row(
                f.label,
                f.place,
                f.says,
                f.ruling.verdict.value,
                f.ruling.correct,
                f.ruling.how,
                f"`{f.check}`",
            )
            for f in members
        ]
    return "\n".join(lines) + "\n"


def _errors(findings: Sequence[AuditRow]) -> list[str]:
    """Return the errors as tables, one of each weight."""
    found = errors(findings)
    lines: list[str] = []
    number = 0
    for weight in Weight:
        causes = [cause for cause in found if cause.weight is weight]
        if not causes:
            continue
        lines += ["", f"## {weight.value.capitalize()}", ""]
        lines += [
            "| | error | where | printed | right | what it changes | rows |",
            "|---:|---|---|---|---|---|---|",
        ]
        for cause in causes:
            number += 1
            rows = [f for f in findings if cause.name in f.causes]
            where = dict.fromkeys(f"{_heading(f.section)}, {f.place}" for f in rows)
            lines.append(
                _row(
                    str(number),
                    cause.name,
                    "; ".join(where),
                    cause.printed,
                    cause.right,
                    cause.changes,
                    "; ".join(f.label for f in rows),
                )
            )
    return lines


def _heading(section: str) -> str:
    return f"Section {section}" if section[0].isdigit() else f"Appendix {section}"


def _row(*cells: str) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |"
