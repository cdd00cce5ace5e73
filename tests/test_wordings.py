"""The whole message of each error of the harness; elsewhere tests ask for type and fields."""

import pickle
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from harness.cli.paper import MissingMathematicsError
from harness.core import errors
from harness.core.errors import HarnessError, OutputError, TrajectoryError
from harness.core.scene_limits import SceneLimitError
from harness.execution.cache import NoCacheError
from harness.execution.cache_entry import read_entry
from harness.execution.worker import Loss, LostTaskError
from harness.gate.baseline import BaselineError, check_place, read_baseline
from harness.report.atomic_folder import check_writable
from harness.studies.comparison.quantity_figures import UnknownQuantityError
from harness.sweep.folder import PlanMismatchError, ProgramMismatchError
from tests.support.trajectories import make_trajectory

MADE: list[tuple[Exception, str]] = [
    (
        errors.UnknownEngineError("ode", ["pybullet", "mujoco"]),
        "unknown engine 'ode'; there are: mujoco, pybullet",
    ),
    (
        errors.UnknownEngineError("mujco", ["mujoco"]),
        "unknown engine 'mujco', did you mean 'mujoco'? there are: mujoco",
    ),
    (
        errors.MissingPackageError("engine 'e'", "p", "no p", "pip install p"),
        (
            "engine 'e' needs the package 'p', which cannot be imported (no p); install it with: "
            "pip install p"
        ),
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
        errors.EngineCrashError("e", "m:C", "SIGSEGV"),
        (
            "engine 'e' falls while it is made from its entry point 'm:C' (SIGSEGV); leave it out "
            "with --engine, or uninstall its package"
        ),
    ),
    (
        errors.EngineContractError("e", "one case", "it returned str"),
        (
            "engine 'e' falls when it is asked for the timestep of the case 'one case' (it "
            "returned str); leave it out with --engine, or mend its adapter"
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
        errors.UnsupportedEffectError("e", "rim", ["b", "a"]),
        (
            "engine 'e' cannot represent the effect 'rim' that the scene declares; engines that "
            "can: a, b"
        ),
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
            "with: pip install 'rockingcan[paper]'"
        ),
    ),
    (LostTaskError(Loss.CRASHED, "killed: SIGSEGV"), "killed: SIGSEGV"),
]


@pytest.mark.parametrize(("error", "message"), MADE, ids=lambda one: type(one).__name__)
def test_an_error_of_parts_has_one_wording_in_each_process(error: Exception, message: str) -> None:
    assert str(error) == message
    sent = pickle.loads(pickle.dumps(error))  # noqa: S301 - just made
    assert (type(sent), str(sent), vars(sent)) == (type(error), message, vars(error))


def test_the_quantities_there_are_end_the_message() -> None:
    message = str(UnknownQuantityError("phy"))
    assert message.startswith("no figure shows 'phy', did you mean 'phi'? there are: phi, ")


RAISED: list[tuple[Callable[[Path], object], type[HarnessError], str]] = [
    (
        lambda folder: check_writable(folder / "file"),
        OutputError,
        "cannot write a report to '{0}/file': it is a file, not a folder",
    ),
    (
        lambda folder: check_writable(folder / "link"),
        OutputError,
        "cannot write a report to '{0}/link': the link leads nowhere",
    ),
    (
        check_writable,
        OutputError,
        (
            "will not replace '{0}': the folder is not empty and holds no report of rockingcan; "
            "choose another folder with --out, or empty it"
        ),
    ),
    (
        lambda folder: check_place(folder / "file"),
        OutputError,
        (
            "cannot write accepted results to '{0}/file': '{0}/file' is no folder that you may "
            "write to; name another with --baseline"
        ),
    ),
    (
        read_baseline,
        BaselineError,
        (
            "'{0}' holds no accepted results ('accepted.json'); write some with: rockingcan "
            "validate --accept --baseline {0}"
        ),
    ),
    (
        lambda _: make_trajectory(0),
        TrajectoryError,
        "`time` must hold at least one instant and increase strictly",
    ),
    (lambda _: read_entry(b"[", "toys", "abcd"), errors.StoreError, "it is no whole record"),
]


@pytest.mark.parametrize(("call", "kind", "message"), RAISED)
def test_what_is_refused_is_said_in_one_sentence(
    call: Callable[[Path], object], kind: type[HarnessError], message: str, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    with pytest.raises(kind) as caught:
        call(tmp_path)
    assert str(caught.value) == message.format(tmp_path)


def descendants(kind: type[Exception]) -> Iterator[type[Exception]]:
    """Yield every class below another."""
    for one in kind.__subclasses__():
        yield one
        yield from descendants(one)


def test_every_error_made_of_parts_is_in_the_table() -> None:
    of_parts = {
        one
        for one in descendants(HarnessError)
        if one.__module__.startswith("harness.") and "__str__" in vars(one)
    }
    assert of_parts - {type(error) for error, _ in MADE} == {UnknownQuantityError}
