"""Whole messages of errors of results: that cannot be read, or are of another run."""

from pathlib import Path

from harness.gate.errors import (
    ChangedScenesError,
    NoCommonCaseError,
    OtherEnginesError,
    OtherSuiteError,
)
from harness.results.errors import Fault, MixedSuitesError, ResultsError

OF_RESULTS: list[tuple[Exception, str]] = [
    *(
        (ResultsError(place=Path("a"), fault=fault, reason="why"), message)
        for fault, message in {
            Fault.MISSING: (
                "'a' holds no accepted results ('accepted.json'); write some with: rockingcan "
                "validate --accept --baseline a"
            ),
            Fault.UNREADABLE: "the result 'a' cannot be read: why",
            Fault.DAMAGED: "the result 'a' is damaged (why)",
            Fault.VERSION: (
                "'a' is no result of version why; write it anew with: rockingcan validate "
                "--accept, or: rockingcan submit"
            ),
            Fault.OBJECTION: (
                "the result 'a' does not hold (why); see all of it with: rockingcan results verify "
                "a"
            ),
            Fault.NO_FOLDER: (
                "'a' is not there; name a file that rockingcan submit wrote, or a folder that "
                "rockingcan validate wrote, with --out or with --accept"
            ),
            Fault.NEITHER: (
                "'a' is neither a report nor accepted results; name a file that rockingcan submit "
                "wrote, or a folder that rockingcan validate wrote, with --out or with --accept"
            ),
            Fault.NO_RESULTS: (
                "'a' holds no results; name a folder of files that rockingcan submit wrote"
            ),
            Fault.DAMAGED_REPORT: "the report in 'a' cannot be read (why)",
            Fault.FOREIGN_REPORT: "'a' is no report of rockingcan",
            Fault.OTHER_REPORT: (
                "'a' is a report, but not of rockingcan validate, or of a version that could not "
                "be compared yet; write it again"
            ),
        }.items()
    ),
    (
        MixedSuitesError(suites=("quick", "full")),
        (
            "the results are of different suites (quick, full), whose cases are not the same; name "
            "results of one suite"
        ),
    ),
    (
        OtherEnginesError(place="a", engines=("mujoco",), accepted=()),
        "'a' holds no accepted results of mujoco, only of none; accept some first, with --accept",
    ),
    (
        OtherSuiteError(place="a", suite="full", accepted="quick", cases=26, common=20),
        (
            "'a' holds the quick suite, which has 20 of the 26 cases of the full suite; run "
            "--suite quick, or accept the full suite with --accept"
        ),
    ),
    (
        ChangedScenesError(place="a", scenes=("petals", "wobble")),
        (
            "'a' was accepted for other scenes: since then petals, wobble changed, and errors of "
            "two motions cannot be compared; accept anew with --accept"
        ),
    ),
    (
        NoCommonCaseError(a=Path("a"), b=Path("b")),
        "'a' and 'b' have no case in common: there is nothing to compare",
    ),
]
