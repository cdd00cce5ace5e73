"""The audit as a table and as a page of Markdown."""

from collections.abc import Sequence
from itertools import groupby

import pandas as pd

from harness.artefact import Prose, Table
from harness.studies.audit.finding import MEANINGS, WRONG, Finding, Verdict

COLUMNS = {
    "label": "The paper's label; text:, caption: and app: name claims without one",
    "section": "Section or appendix of the paper",
    "says": "The claim",
    "verdict": "How it stands",
    "correct": "The right form or number, where it is another; or a remark",
    "how": "How it was checked, with what decided",
    "check": "The function that computed the verdict, under harness/studies/audit/checks",
}
PAPER = "Collins, Hall and Hogan, *The rocking can*, arXiv:2302.08335"


def audit_table(findings: Sequence[Finding]) -> Table:
    """Return the findings as a table, a row each, in the order of the paper's sections."""
    rows = [
        {
            "label": finding.label,
            "section": finding.section,
            "says": finding.says,
            "verdict": finding.ruling.verdict.value,
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


def counts(findings: Sequence[Finding]) -> dict[Verdict, int]:
    """Return how many claims have each verdict."""
    return {v: sum(f.ruling.verdict is v for f in findings) for v in Verdict}


def audit_words(findings: Sequence[Finding]) -> Prose:
    """Return how many claims stand, in two sentences."""
    found = counts(findings)
    told = ", ".join(f"{number} {verdict.value}" for verdict, number in found.items() if number)
    wrong = [f for f in findings if f.ruling.verdict in WRONG]
    first = f"Of {len(findings)} claims of the paper: {told}."
    second = f"The first that is wrong is {wrong[0].label}." if wrong else "None is wrong."
    return Prose(name="summary", title="Summary", text=f"{first} {second}")


def markdown(findings: Sequence[Finding]) -> str:
    """Return the audit as a page: the verdicts counted, what is wrong, then every claim.

    Parameters
    ----------
    findings : sequence of Finding
    """
    found = counts(findings)
    lines = [
        "# Audit of the paper",
        "",
        (
            f"Every labelled equation and every number of {PAPER}, checked by computation. "
            "Written by `rockingcan audit`; each verdict is computed by the check named beside it."
        ),
        "",
        "| verdict | claims | meaning |",
        "|---|---:|---|",
        *(f"| {v.value} | {found[v]} | {MEANINGS[v]} |" for v in Verdict),
        f"| all | {len(findings)} | |",
        "",
        "## What is wrong, and what is right",
        "",
        "| label | section | printed | verdict | correct |",
        "|---|---|---|---|---|",
    ]
    lines += [
        _row(f.label, f.section, f.says, f.ruling.verdict.value, f.ruling.correct)
        for f in findings
        if f.ruling.verdict in WRONG
    ]
    for section, members in groupby(findings, key=lambda f: f.section):
        lines += ["", f"## {_heading(section)}", ""]
        lines += [
            "| label | says | verdict | how it was checked | check |",
            "|---|---|---|---|---|",
        ]
        lines += [
            _row(f.label, f.says, f.ruling.verdict.value, f.ruling.how, f"`{f.check}`")
            for f in members
        ]
    return "\n".join(lines) + "\n"


def _heading(section: str) -> str:
    return f"Section {section}" if section[0].isdigit() else f"Appendix {section}"


def _row(*cells: str) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |"
