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
from harness.report.layout import Report
from harness.report.number_format import is_missing, readable
from harness.report.section import FIDELITY
from harness.report.tables import rows

_ALIEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 has no way to write, not even as a reference."""

_PASSED = ("agrees", "same", "better")
_FAILED = ("deviates", "failed", "worse", "missing")

_GATE = "gate"
"""Name of the table of results against accepted ones."""


def junit(report: Report) -> str:
    """Return the verdicts of a report; an empty list where no engine was compared."""
    verdicts = [row for table in report.tables.values() for row in _rows(table)]
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
    names = [str(name) for name in table.frame.columns]
    told = (dict(zip(names, row, strict=True)) for row in rows(table.frame))
    if table.name == FIDELITY:
        yield from ({**row, "suite": row["engine"]} for row in told)
    elif table.name == _GATE:
        yield from (_held(row) for row in told if row["verdict"] != "not judged")


def _held(row: dict[str, Any]) -> dict[str, Any]:
    """Return a comparison with an accepted result in the words of a verdict."""
    step = "" if is_missing(row["timestep_s"]) else f", {row['timestep_s']:g} s"
    note = f": {row['note']}" if row["note"] else ""
    return {
        **row,
        "suite": f"{row['engine']}, against accepted results",
        "profile": f"{row['profile']}{step}",
        "verdict": f"{row['verdict']}{note}",
        "value": row["found"],
        "allowed": _allowed(row["accepted"], row["tolerance"]),
        "command": f"case {row['case']}",
    }


def _allowed(accepted: float | None, tolerance: float | None) -> float | None:
    """Return how large a magnitude may be for its tolerance, if there is such a number."""
    if is_missing(accepted) or is_missing(tolerance):
        return None
    return (accepted or 0.0) + (tolerance or 0.0)


def _case(row: dict[str, Any]) -> Element:
    scene, profile, quantity = (str(row[key]) for key in ("scene", "profile", "quantity"))
    case = _element("testcase", classname=f"{row['engine']}.{scene}", name=f"{quantity}, {profile}")
    verdict = str(row["verdict"])
    if verdict.startswith(_FAILED):
        failure = SubElement(
            case, "failure", _told(message=verdict, type=verdict.partition(" ")[0].rstrip(":"))
        )
        failure.text = _clean(_numbers(row))
    elif not verdict.startswith(_PASSED):
        SubElement(case, "skipped", _told(message=verdict))
    return case


def _numbers(row: dict[str, Any]) -> str:
    """Return the numbers behind a verdict, and how to get them again."""
    value = "no number" if is_missing(row["value"]) else readable(row["value"])
    allowed = "" if is_missing(row["allowed"]) else f", allowed {readable(row['allowed'])}"
    return f"{row['quantity']}: {value}{allowed}\n{row['command']}"


def _counts(verdicts: list[dict[str, Any]]) -> dict[str, str]:
    words = [str(row["verdict"]) for row in verdicts]
    failures = sum(word.startswith(_FAILED) for word in words)
    passed = sum(word.startswith(_PASSED) for word in words)
    return {
        "tests": str(len(words)),
        "failures": str(failures),
        "skipped": str(len(words) - failures - passed),
    }


def _element(tag: str, **attributes: str) -> Element:
    return Element(tag, _told(**attributes))


def _told(**attributes: str) -> dict[str, str]:
    return {name: _clean(value) for name, value in attributes.items()}


def _clean(text: str) -> str:
    return _ALIEN.sub("\N{REPLACEMENT CHARACTER}", text)
