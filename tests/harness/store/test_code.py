"""The fingerprint of the program changes with whatever decides a result, and with that alone."""

import importlib.util
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from harness.case import Case
from harness.keys import about, is_current, key_of
from harness.store import code
from harness.store.code import fingerprint
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
    deciding = {(code._ROOT / place).exists() for place in code._DECIDING}  # noqa: SLF001
    assert deciding == {True}
    assert fingerprint("harness.engines.mujoco.engine") == fingerprint()
    assert fingerprint("harness.timing.errors") != fingerprint()


def test_a_key_tells_cases_engines_and_work_apart(brief: Scene) -> None:
    case = Case(scene=brief, engine="mujoco", timestep=1e-3)
    keys = {
        key_of(case),
        key_of(Case(scene=brief, engine="mujoco", timestep=2e-3)),
        key_of(Case(scene=brief, engine="pybullet", timestep=1e-3)),
        key_of(case, "harness.timing.errors"),
    }
    assert len(keys) == 4
    assert key_of(case) == key_of(Case(scene=brief, engine="mujoco", timestep=1e-3))


def test_what_another_program_made_is_out_of_date(brief: Scene) -> None:
    told = about(Case(scene=brief, engine="mujoco"), "harness.timing.errors")
    assert is_current(told)
    assert not is_current(replace(told, code="another"))
    assert not is_current(replace(told, engine_version="0.1"))
    assert not is_current(replace(told, engine="no longer there"))
