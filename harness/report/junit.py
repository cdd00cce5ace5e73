"""The verdicts as JUnit's XML, which build servers show beside their tests.

A test case is a quantity of one engine in one scene. What agrees passes, what deviates or failed is
a failure, what is unsupported or cannot be decided is skipped, with the words of the verdict. Where
results were held against accepted ones, each comparison is a test case of a suite of its own.
"""

import re
from collections.abc import Iterable
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from harness.core.report_model import Table
from harness.core.verdict import Status, Verdict
from harness.report.layout import FIDELITY, Report
from harness.report.number_format import readable
from harness.report.tables import Row, records

_ALIEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 has no way to write, not even as a reference."""

_GATE = "gate"
"""Name of the table of results against accepted ones."""


def junit(report: Report) -> str:
    """Return the verdicts of a report; an empty list where no engine was compared."""
    every = (row for table in report.tables.values() for row in _rows(table))
    verdicts = [row for row in every if row["verdict"].status is not Status.NOT_JUDGED]
    suites = _element("testsuites", name=report.title)
    for name in dict.fromkeys(row["suite"] for row in verdicts):
        own = [row for row in verdicts if row["suite"] == name]
        suite = SubElement(suites, "testsuite", _told(name=name, **_counts(own)))
        for row in own:
            suite.append(_case(row))
    for name, number in _counts(verdicts).items():
        suites.set(name, number)
    indent(suites)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + tostring(suites, encoding="unicode") + "\n"


def _rows(table: Table) -> Iterable[dict[str, Any]]:
    """Yield the verdicts of a table: each row with the keys `suite` and `verdict`."""
    if table.name == FIDELITY:
        yield from ({**row, "suite": row["engine"]} for row in records(table))
    elif table.name == _GATE:
        yield from map(_held, records(table))


def _held(row: Row) -> dict[str, Any]:
    """Return a comparison with an accepted result as fidelity has them."""
    step = "" if row["timestep_s"] is None else f", {row['timestep_s']:g} s"
    verdict, note = row["verdict"], f": {row['note']}" if row["note"] else ""
    return {
        **row,
        "suite": f"{row['engine']}, against accepted results",
        "profile": f"{row['profile']}{step}",
        "verdict": Verdict(verdict.status, f"{verdict.text}{note}"),  # type: ignore[attr-defined]
        "value": row["found"],
        "allowed": _allowed(row["accepted"], row["tolerance"]),
        "command": f"case {row['case']}",
    }


def _allowed(accepted: object, tolerance: object) -> float | None:
    """Return how large a magnitude may be for its tolerance, if there is such a number."""
    if not (isinstance(accepted, float) and isinstance(tolerance, float)):
        return None
    return accepted + tolerance


def _case(row: dict[str, Any]) -> Element:
    scene, profile, quantity = (str(row[key]) for key in ("scene", "profile", "quantity"))
    case = _element("testcase", classname=f"{row['engine']}.{scene}", name=f"{quantity}, {profile}")
    verdict: Verdict = row["verdict"]
    if verdict.status.failed:
        told = _told(message=verdict.text, type=verdict.status.value)
        SubElement(case, "failure", told).text = _clean(_numbers(row))
    elif not verdict.status.passed:
        SubElement(case, "skipped", _told(message=verdict.text))
    return case


def _numbers(row: dict[str, Any]) -> str:
    """Return the numbers behind a verdict, and how to get them again."""
    value = "no number" if row["value"] is None else readable(row["value"])
    allowed = "" if row["allowed"] is None else f", allowed {readable(row['allowed'])}"
    return f"{row['quantity']}: {value}{allowed}\n{row['command']}"


def _counts(verdicts: list[dict[str, Any]]) -> dict[str, str]:
    statuses = [row["verdict"].status for row in verdicts]
    failures = sum(status.failed for status in statuses)
    passed = sum(status.passed for status in statuses)
    return {
        "tests": str(len(statuses)),
        "failures": str(failures),
        "skipped": str(len(statuses) - failures - passed),
    }


def _element(tag: str, **attributes: str) -> Element:
    return Element(tag, _told(**attributes))


def _told(**attributes: str) -> dict[str, str]:
    return {name: _clean(value) for name, value in attributes.items()}


def _clean(text: str) -> str:
    return _ALIEN.sub("\N{REPLACEMENT CHARACTER}", text)
