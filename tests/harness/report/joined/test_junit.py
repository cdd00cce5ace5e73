"""The verdicts as JUnit's XML: counted, told apart, and safe."""

from pathlib import Path
from xml.etree import ElementTree as ET

from harness.core.provenance import Provenance
from harness.report.write import write_report


def suites(folder: Path) -> ET.Element:
    # our own file: no entity in it can be expanded, since none is declared
    return ET.fromstring((folder / "junit.xml").read_text(encoding="utf-8"))  # noqa: S314


def test_verdicts_are_counted(joined_report: Path) -> None:
    root = suites(joined_report)
    counts = {"tests": "6", "failures": "3", "skipped": "1"}
    assert {key: root.attrib[key] for key in counts} == counts
    (suite,) = root
    assert {key: suite.attrib[key] for key in counts} == counts
    assert suite.attrib["name"] == "mujoco"


def test_a_failure_says_the_number_and_the_command(joined_report: Path) -> None:
    failure = suites(joined_report).find(".//testcase[@name='turn_error_deg, default']/failure")
    assert failure is not None
    assert failure.attrib == {"message": "deviates by a factor 3", "type": "deviates"}
    told = "turn_error_deg: 0.3, allowed 0.1\nrockingcan run gentle-rock --engine mujoco"
    assert failure.text == told


def test_what_cannot_be_decided_is_skipped(joined_report: Path) -> None:
    case = suites(joined_report).find(".//testcase[@name='friction_ratio_error, matched']")
    assert case is not None
    (skipped,) = case
    assert skipped.tag == "skipped"
    assert skipped.attrib["message"] == "not decidable: the scene has no bounce"


def test_hostile_texts_stay_texts(joined_report: Path, hostile_joined_report: Path) -> None:
    root = suites(hostile_joined_report)
    assert [e.tag for e in root.iter()] == [e.tag for e in suites(joined_report).iter()]
    case = next(root.iter("testcase"))
    assert "<script>" in case.attrib["classname"]
    assert "\x0b" not in case.attrib["classname"]  # no XML can hold it


def test_a_report_that_compares_nothing_has_no_tests(
    provenance: Provenance, tmp_path: Path
) -> None:
    write_report((), tmp_path / "report", title="t", cases=(), provenance=provenance)
    assert suites(tmp_path / "report").attrib["tests"] == "0"
