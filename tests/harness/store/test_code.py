"""The fingerprint of the program changes with whatever decides a result, and with that alone."""

import importlib.util
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from harness.core.case import Case
from harness.evaluation.case_cache import case_key, case_metadata, is_current
from harness.execution import source_fingerprint
from harness.execution.source_fingerprint import fingerprint
from models import Scene


@pytest.fixture
def engine_module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Return the source of a module that can be imported."""
    path = tmp_path / "some_engine.py"
    path.write_text("A = 1\n", encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    fingerprint.cache_clear()
    yield path
    sys.modules.pop("some_engine", None)
    fingerprint.cache_clear()


def test_an_adapter_that_is_edited_is_another(engine_module: Path) -> None:
    before = fingerprint("some_engine")
    assert before != fingerprint()
    fingerprint.cache_clear()
    assert fingerprint("some_engine") == before
    engine_module.write_text("A = 2\n", encoding="utf-8")
    fingerprint.cache_clear()
    assert fingerprint("some_engine") != before
    assert importlib.util.find_spec("some_engine") is not None


def test_what_is_measured_with_is_part_of_it() -> None:
    root, places = source_fingerprint._ROOT, source_fingerprint._DECIDING  # noqa: SLF001
    deciding = {(root / place).exists() for place in places}
    assert deciding == {True}
    assert fingerprint("harness.engines.mujoco.engine") == fingerprint()
    assert fingerprint("harness.evaluation.case_record") != fingerprint()


def test_a_key_tells_cases_engines_and_work_apart(brief: Scene) -> None:
    case = Case(scene=brief, engine="mujoco", timestep=1e-3)
    keys = {
        case_key(case),
        case_key(Case(scene=brief, engine="mujoco", timestep=2e-3)),
        case_key(Case(scene=brief, engine="pybullet", timestep=1e-3)),
        case_key(case, "harness.evaluation.case_record"),
    }
    assert len(keys) == 4
    assert case_key(case) == case_key(Case(scene=brief, engine="mujoco", timestep=1e-3))


def test_what_another_program_made_is_out_of_date(brief: Scene) -> None:
    told = case_metadata(Case(scene=brief, engine="mujoco"), "harness.evaluation.case_record")
    assert is_current(told)
    assert not is_current(replace(told, code="another"))
    assert not is_current(replace(told, engine_version="0.1"))
    assert not is_current(replace(told, engine="no longer there"))
