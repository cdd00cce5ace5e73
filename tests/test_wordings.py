"""The whole message of each error of the harness; elsewhere tests ask for type and fields."""

import pickle
from collections.abc import Iterator
from pathlib import Path

import pytest

from harness.cli.main import StandardOutputError
from harness.cli.motions import BrokenRunError
from harness.cli.paper import MissingMathematicsError
from harness.cli.study_command import FiguresWithoutReportError
from harness.core import errors
from harness.core.engine_packages import install_command
from harness.core.errors import HarnessError
from harness.core.scene_limits import SceneLimitError
from harness.core.trajectory import ArrayShapeError, TimeOrderError
from harness.core.writing import ForeignFolderError, UndrawnFiguresError, WriteError
from harness.execution.cache import NoCacheError
from harness.execution.cache_entry import BrokenEntryError, Defect
from harness.execution.dask_cluster import (
    LateWorkerError,
    LostSchedulerError,
    NoSchedulerError,
    NoWorkersError,
    UnfitWorkersError,
    UnknownWorkersError,
)
from harness.execution.worker import Loss, LostTaskError
from harness.report.stored import ReportVersionError, UnreadableReportError
from harness.results.errors import Fault, ResultsError
from harness.studies.comparison.quantity_figures import (
    NothingToDrawError,
    NotRunsError,
    UnknownQuantityError,
)
from harness.sweep.folder import (
    PartitionError,
    PlanMismatchError,
    ProgramMismatchError,
    RowsMismatchError,
    SweepBusyError,
    UnreadablePartitionError,
    UnreadablePlanError,
)
from tests.support.engine_wordings import OF_ENGINES
from tests.support.result_wordings import OF_RESULTS

MADE: list[tuple[Exception, str]] = [
    *OF_ENGINES,
    *OF_RESULTS,
    (
        errors.UnknownEngineError("ode", ["pybullet", "mujoco"]),
        "unknown engine 'ode'; there are: mujoco, pybullet",
    ),
    (
        errors.UnknownEngineError("mujco", ["mujoco"]),
        "unknown engine 'mujco', did you mean 'mujoco'? there are: mujoco",
    ),
    (
        errors.MissingPackageError("engine 'e'", "p", "no p", "i"),
        "engine 'e' needs the package 'p', which cannot be imported (no p); install it with: i",
    ),
    (
        errors.MissingCheckoutError("tests/faults"),
        (
            "this needs 'tests/faults' of the source checkout, which an installed package does not "
            "have; get the checkout from where the package is developed, and in it run: make test, "
            "then .venv/bin/python -m tests.faults"
        ),
    ),
    (
        errors.BrokenEngineError("e", "m:C", "TypeError"),
        (
            "engine 'e' cannot be made from its entry point 'm:C' (TypeError); the entry point "
            "must name a class that is made without arguments"
        ),
    ),
    (
        errors.BrokenPackageError("e", "m:C", "no symbol"),
        "engine 'e' is installed, and cannot be imported (no symbol): another build of it may do",
    ),
    (
        errors.EngineCrashError("e", "m:C", "SIGSEGV"),
        (
            "engine 'e' falls while it is made from its entry point 'm:C' (SIGSEGV); leave it out "
            "with --engine, or uninstall its package"
        ),
    ),
    (
        errors.UnknownSettingError("e", "viscosity", ["b", "a"]),
        "engine 'e' has no setting 'viscosity'; its settings are: a, b",
    ),
    (
        errors.UnknownSettingError("e", "viscosity", []),
        "engine 'e' has no setting 'viscosity'; its settings are: none",
    ),
    (
        errors.InvalidSettingError("timestep", 0.0, "a positive number of seconds"),
        "setting 'timestep' cannot be 0.0; allowed: a positive number of seconds",
    ),
    (
        errors.InvalidSettingError("cone", "eliptic", "pyramidal or elliptic"),
        (
            "setting 'cone' cannot be 'eliptic', did you mean 'elliptic'? allowed: pyramidal or "
            "elliptic"
        ),
    ),
    (
        errors.InvalidSettingError("method", "DOP853", "auto: it is not 'DOP853'"),
        "setting 'method' cannot be 'DOP853'; allowed: auto: it is not 'DOP853'",
    ),
    (
        errors.UnsupportedEffectError("", "r", ["b", "a"]),
        "engine '' cannot represent the effect 'r' that the scene declares; engines that can: a, b",
    ),
    (
        errors.UnsupportedEffectError("e", "rim", []),
        (
            "engine 'e' cannot represent the effect 'rim' that the scene declares; engines that "
            "can: none of the installed engines"
        ),
    ),
    (
        errors.EffectBelowMinimumError("e", "slip.mu", 9e-6, 1e-5, ["b", "a"]),
        (
            "engine 'e' cannot represent 'effects.slip.mu' = 9e-06 that the scene declares: it "
            "takes 1e-05 or more; engines that can: a, b"
        ),
    ),
    (
        errors.RefusedModelError("e", "one case", "too\n  light"),
        "engine 'e' does not compile the case 'one case': too light",
    ),
    (
        errors.ParityError("one case", "mass"),
        (
            "one case: the engine's model is not the scene's in: mass (see the parity table); "
            "leave the settings that cause it at the profile's, or use --profile default"
        ),
    ),
    (
        SceneLimitError("s", "can.mass", 1e10, "from 1e-09 to 1e+09 kg"),
        "scene 's': 'can.mass' is 1e+10, but to be run must be from 1e-09 to 1e+09 kg",
    ),
    (
        PlanMismatchError(Path("out"), "the scene"),
        (
            "'out' holds another sweep, which differs in the scene; choose another folder with "
            "--out, or remove this one"
        ),
    ),
    (
        RowsMismatchError(Path("out"), "with rows"),
        ("'out' holds a sweep with rows; choose another folder with --out, or remove this one"),
    ),
    (
        ProgramMismatchError(Path("out"), "numpy 1 (now 2)"),
        (
            "'out' holds this sweep as another program made it, with numpy 1 (now 2): rows of both "
            "might not go together; choose another folder with --out, or remove this one to make "
            "all anew"
        ),
    ),
    (
        NoCacheError(Path("store"), "it is not there"),
        (
            "there is no store at 'store': it is not there; name one with --store, or run "
            "something that keeps its results there"
        ),
    ),
    (
        MissingMathematicsError("no sympy"),
        (
            "the audit needs sympy and mpmath, which cannot be imported (no sympy); install them "
            f"with: {install_command(['rockingcan[paper]'])}"
        ),
    ),
    (
        FiguresWithoutReportError(),
        "--figures needs --out: the figures are written into the folder of the report",
    ),
    (
        NotRunsError("int"),
        (
            "runs are drawn: an Evaluation, a Comparison, or several Evaluations; this is of type "
            "'int'. Rows of a Comparison are drawn by: "
            "plot([comparison.evaluations[row] for row in rows.index])"
        ),
    ),
    (LostTaskError(Loss.CRASHED, "killed: SIGSEGV"), "killed: SIGSEGV"),
    (
        BrokenRunError(case="one case", note="no number"),
        "one case: no number",
    ),
    (StandardOutputError(reason="full"), "cannot write to standard output: full"),
    (
        ArrayShapeError(name="time", shape=(3,), expected=(4,)),
        "`time` has shape (3,), but 4 samples need (4,)",
    ),
    (TimeOrderError(), "`time` must hold at least one instant and increase strictly"),
    (WriteError(path=Path("a"), reason="full"), "cannot write 'a': full"),
    (
        WriteError(path=Path("a"), reason="full", what="a report to", fix="make room"),
        "cannot write a report to 'a': full; make room",
    ),
    (
        UndrawnFiguresError(folder=Path("a b"), titles=("A", "B"), reason="killed: SIGBUS"),
        (
            "the report in 'a b' is written without the figures for paper of 'A', 'B' (killed: "
            "SIGBUS); to draw them again: rockingcan report 'a b' --figures"
        ),
    ),
    (
        ForeignFolderError(path=Path("a"), action="replace", thing="report", fix="empty it"),
        "will not replace 'a': the folder is not empty and holds no report of rockingcan; empty it",
    ),
    (
        UnreadableReportError(path=Path("a"), reason="it is no record of a report"),
        "cannot read 'a': it is no record of a report",
    ),
    (
        UnreadableReportError(path=Path("a"), reason="full", fix="name a folder"),
        "cannot read 'a': full; name a folder",
    ),
    (
        ReportVersionError(path=Path("a"), version=1),
        (
            "cannot read 'a': it is of version 1, this reads 2; write the report again with the "
            "command that made it"
        ),
    ),
    (BrokenEntryError(defect=Defect.FORMAT), "it is of another format"),
    (BrokenEntryError(defect=Defect.CHECKSUM), "its checksum is not that of its content"),
    (BrokenEntryError(defect=Defect.OTHER_CASE), "it is the entry of another case"),
    (BrokenEntryError(defect=Defect.CUT_SHORT), "its arrays are cut short"),
    (BrokenEntryError(defect=Defect.ARRAYS), "the checksum of its arrays is not theirs"),
    (BrokenEntryError(defect=Defect.NO_RECORD), "it is no whole record"),
    (
        BrokenEntryError(defect=Defect.UNREADABLE, reason="a bad block"),
        "it cannot be read: a bad block",
    ),
    (SweepBusyError(out=Path("a")), "a sweep is already at work in 'a'; wait for it"),
    (
        UnreadablePlanError(place=Path("a/sweep.json"), reason="it is cut"),
        (
            "the plan of the sweep in 'a' cannot be read (it is cut); remove 'a/sweep.json' and "
            "start the same sweep again, which goes on with the partitions that are there, or "
            "choose another folder with --out"
        ),
    ),
    (
        PartitionError(parts=Path("a/parts"), index=3),
        "partition 3 in 'a/parts' is missing or damaged; run the sweep again to mend it",
    ),
    (
        UnreadablePartitionError(path=Path("a"), reason="another Arrow"),
        "cannot read 'a' (another Arrow); remove it",
    ),
    (
        NoSchedulerError(address="host:1", reason="refused"),
        (
            "no Dask scheduler answers at 'host:1' (refused); start one with: dask scheduler, and "
            "workers with: dask worker ADDRESS"
        ),
    ),
    (
        NoWorkersError(address="host:1"),
        "the cluster at 'host:1' has no workers; start: dask worker ADDRESS",
    ),
    (
        UnknownWorkersError(address="host:1", reason="TimeoutError: late"),
        (
            "workers of the cluster at 'host:1' cannot say what they compute with (TimeoutError: "
            "late); have the same there as here, and start the workers again"
        ),
    ),
    (
        UnfitWorkersError(address="host:1", workers={"a": "has x 1 (here 2)", "b": "cannot say"}),
        (
            "workers of the cluster at 'host:1' would not compute as it is done here: a has x 1 "
            "(here 2); b cannot say; have the same there as here, and start the workers again"
        ),
    ),
    (
        LateWorkerError(node="n", differences=("x 1 (here 2)", "y 3 (here 4)")),
        (
            "a worker on 'n' would not compute as it is done here: it has x 1 (here 2), y 3 (here "
            "4); have the same there as here, and start the workers again"
        ),
    ),
    (
        LostSchedulerError(),
        "the scheduler let go of a task, or is gone; start again to go on",
    ),
    (
        LostSchedulerError(reason="timed out"),
        "the scheduler let go of a task, or is gone; start again to go on (timed out)",
    ),
    (
        NothingToDrawError(scenes=()),
        "a figure is of runs of one scene; there are none",
    ),
    (
        NothingToDrawError(scenes=("wobble", "petals")),
        "a figure is of runs of one scene; these are of wobble, petals",
    ),
    (
        NothingToDrawError(scenes=("wobble",), quantity="phi", drawn=("bounce", "angles")),
        "the runs have no figure 'phi'; they have: bounce, angles",
    ),
    (
        NothingToDrawError(scenes=("wobble",), endings=("killed", "flat")),
        "the runs have no figure; killed; flat",
    ),
    (
        errors.CacheWarning(Path("a"), "it is cut", Path("aside")),
        "a: it is cut; it is set aside in 'aside' and done again",
    ),
]


@pytest.mark.parametrize(("error", "message"), MADE, ids=lambda one: type(one).__name__)
def test_an_error_of_parts_has_one_wording_in_each_process(error: Exception, message: str) -> None:
    assert str(error) == message
    sent = pickle.loads(pickle.dumps(error))  # noqa: S301 - just made
    assert (type(sent), str(sent), vars(sent)) == (type(error), message, vars(error))


def test_the_quantities_there_are_end_the_message() -> None:
    message = str(UnknownQuantityError("phy"))
    assert message.startswith("no figure shows 'phy', did you mean 'phi'? there are: phi, ")


def descendants(kind: type[Exception]) -> Iterator[type[Exception]]:
    """Yield every class below another."""
    for one in kind.__subclasses__():
        yield one
        yield from descendants(one)


def test_every_reason_not_to_read_is_in_the_table() -> None:
    assert {one.fault for one, _ in MADE if isinstance(one, ResultsError)} == set(Fault)
    assert {one.defect for one, _ in MADE if isinstance(one, BrokenEntryError)} == set(Defect)


def test_every_error_made_of_parts_is_in_the_table() -> None:
    of_parts = {
        one
        for one in descendants(HarnessError)
        if one.__module__.startswith("harness.") and "__str__" in vars(one)
    }
    assert of_parts - {type(error) for error, _ in MADE} == {UnknownQuantityError}
