"""Engines that fall while they are made: named, and nothing falls with them."""

import os
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from harness.core.case import Case
from harness.core.engine_packages import ENGINE_ENTRY_POINTS
from harness.core.errors import (
    BrokenEngineError,
    EngineContractError,
    EngineCrashError,
    HarnessError,
)
from harness.engines import plugin_probe, registry
from harness.evaluation.evaluate import check_case
from harness.execution.isolated_pool import IsolatedProcessPool
from harness.execution.limits import Limits
from harness.execution.worker_main import is_worker
from models import Scene

CRASHES = "import ctypes\nctypes.string_at(0)\n"
LEAVES = "import os\nos._exit(7)\n"
HANGS = "while True:\n    pass\n"
SOUND = """
class Engine:
    name, version, settings, capabilities = "mine", "1", (), None
"""
CRASHES_WHEN_ASKED = """
import ctypes
class Engine:
    name, settings, capabilities = "mine", (), None
    version = property(lambda self: ctypes.string_at(0))
"""
HANGS_WHEN_ASKED = """
class Engine:
    name, version, settings, capabilities = "mine", "1", (), None
    def timestep(self, case):
        while case.profile == "adaptive":
            pass
"""
CHOOSY = """
import ctypes, os
from harness.core.errors import InvalidSettingError
def told(case):
    if case.timestep == 1e-3:
        ctypes.string_at(0)
    if case.timestep == 2e-3:
        return 1.0 / 0.0
    if case.timestep == 3e-3:
        raise InvalidSettingError("timestep", case.timestep, "another")
    if case.timestep == 4e-3:
        return "soon"
    return float(os.getpid())
class Engine:
    name, version, settings, capabilities = "mine", "1", (), None
    def timestep(self, case):
        return None if case.timestep is None else told(case)
"""
"""Answers for the timesteps that a profile has of its own."""


@pytest.fixture
def planted(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> EntryPoint:
    """Plant a module of the text that the test is given, and return an entry point to it."""
    module = f"planted_{abs(hash(request.param))}"
    (tmp_path / f"{module}.py").write_text(request.param, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    entry = EntryPoint(name=module, value=f"{module}:Engine", group=ENGINE_ENTRY_POINTS)
    monkeypatch.setattr(registry, "_entries", lambda: {module: entry})
    return entry


@pytest.mark.parametrize(
    ("planted", "reason"),
    [(CRASHES, "SIGSEGV"), (LEAVES, "code 7"), (CRASHES_WHEN_ASKED, "SIGSEGV")],
    indirect=["planted"],
)
def test_an_engine_that_kills_the_process_is_named(planted: EntryPoint, reason: str) -> None:
    with pytest.raises(EngineCrashError) as caught:
        registry.engine(planted.name)
    assert (caught.value.engine, caught.value.entry) == (planted.name, planted.value)
    assert reason in caught.value.reason


@pytest.mark.slow
@pytest.mark.parametrize("planted", [HANGS, HANGS_WHEN_ASKED], indirect=True)
def test_an_engine_that_never_ends_its_import_or_its_answer_is_named(
    planted: EntryPoint, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plugin_probe, "_PATIENCE", Limits(seconds=2.0))
    with pytest.raises(EngineCrashError) as caught:
        registry.engine(planted.name)
    assert "longer than the 2 s allowed" in caught.value.reason


@pytest.mark.parametrize("planted", [SOUND], indirect=True)
def test_a_sound_engine_is_made_as_before(planted: EntryPoint) -> None:
    assert plugin_probe.crash_reason(planted) == ""
    assert registry.engine(planted.name).version == "1"


RAISES_WHEN_ASKED = """
class Engine:
    name, settings, capabilities = "mine", (), None
    @property
    def version(self):
        raise ValueError("no licence")
"""


@pytest.mark.parametrize(
    "planted", ["raise ValueError('no licence')\n", RAISES_WHEN_ASKED], indirect=True
)
def test_an_error_in_python_is_told_as_itself(planted: EntryPoint) -> None:
    with pytest.raises(BrokenEngineError) as caught:
        registry.engine(planted.name)
    assert caught.value.reason == "ValueError: no licence"
    assert not isinstance(caught.value, EngineCrashError)


def test_in_a_worker_nothing_is_tried_in_a_process_of_its_own() -> None:
    unheard = EntryPoint(name="x", value="no_such_module:Engine", group=ENGINE_ENTRY_POINTS)
    with IsolatedProcessPool(1) as alone:
        assert alone.submit(plugin_probe.crash_reason, unheard).result() == ""
        assert alone.submit(is_worker).result()
    assert not is_worker()


@pytest.mark.parametrize("planted", [CHOOSY], indirect=True)
@pytest.mark.parametrize(
    ("timestep", "error", "reason"),
    [
        (1e-3, EngineContractError, "SIGSEGV, segmentation fault"),
        pytest.param(
            2e-3,
            EngineContractError,
            "`timestep` raised ZeroDivisionError: ",
            marks=pytest.mark.slow,
        ),
        pytest.param(3e-3, HarnessError, "allowed: another", marks=pytest.mark.slow),
        (4e-3, EngineContractError, "it returned str, not a positive number"),
    ],
)
def test_an_engine_that_falls_over_one_case_is_named_with_it(
    planted: EntryPoint, brief: Scene, timestep: float, error: type[HarnessError], reason: str
) -> None:
    assert plugin_probe.crash_reason(planted) == ""
    case = Case(scene=brief, engine=planted.name, timestep=timestep)
    with pytest.raises(error, match=reason) as caught:
        check_case(case)
    assert error is HarnessError or case.label() in str(caught.value)


@pytest.mark.parametrize("planted", [CHOOSY], indirect=True)
def test_one_process_is_asked_for_all_cases_and_once_for_each(
    planted: EntryPoint, brief: Scene
) -> None:
    cases = [Case(scene=brief, engine=planted.name, timestep=n * 1e-2) for n in (1, 2, 3)]
    asked = plugin_probe.timestep_from_worker.cache_info()
    told = {registry.timestep_of(case) for case in cases for _ in range(4)}
    assert len(told) == 1
    assert told != {float(os.getpid())}
    assert plugin_probe.timestep_from_worker.cache_info().misses - asked.misses == len(cases)


def test_engines_of_ours_are_asked_here(brief: Scene) -> None:
    asked = plugin_probe.timestep_from_worker.cache_info()
    assert registry.timestep_of(Case(scene=brief, engine="mujoco", timestep=1e-3)) == 1e-3
    assert plugin_probe.timestep_from_worker.cache_info() == asked
