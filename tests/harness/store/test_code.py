"""The fingerprint of the program changes with whatever decides a result, and with that alone."""

import importlib.util
import shutil
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from harness.core.case import Case
from harness.core.engine_packages import versions_behind
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
    root, places = source_fingerprint.ROOT, source_fingerprint._DECIDING  # noqa: SLF001
    deciding = {(root / place).exists() for place in places}
    assert deciding == {True}
    assert fingerprint("harness.engines.stepping.schedule") == fingerprint()
    assert fingerprint("harness.evaluation.case_record") != fingerprint()


def test_an_adapter_decides_for_its_own_engine_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(source_fingerprint.ROOT / "harness/engines", tmp_path / "harness/engines")
    shutil.copytree(source_fingerprint.ROOT / "harness/metrics", tmp_path / "harness/metrics")
    monkeypatch.setattr(source_fingerprint, "ROOT", tmp_path)
    monkeypatch.setattr(source_fingerprint, "_ENGINES", tmp_path / "harness/engines")
    monkeypatch.setattr(source_fingerprint, "_DECIDING", ("harness/metrics", "harness/engines"))
    monkeypatch.setattr(
        source_fingerprint, "_source", lambda name: tmp_path / f"{name.replace('.', '/')}.py"
    )

    def prints() -> dict[str, str]:
        fingerprint.cache_clear()
        source_fingerprint._adapters.cache_clear()  # noqa: SLF001 - of folders that are elsewhere
        names = ("mujoco", "mujoco.mjx", "pybullet", "drake")
        return {name: fingerprint(f"harness.engines.{name}.engine") for name in names}

    def changed_by(file: str) -> set[str]:
        before = prints()
        with (tmp_path / "harness" / file).open("a") as source:
            source.write("# edited\n")
        after = prints()
        return {name for name in after if after[name] != before[name]}

    try:
        assert changed_by("engines/pybullet/world.py") == {"pybullet"}
        assert changed_by("engines/mujoco/world.py") == {"mujoco", "mujoco.mjx"}
        assert changed_by("engines/dart/world.py") == set()
        everything = {"mujoco", "mujoco.mjx", "pybullet", "drake"}
        assert changed_by("engines/stepping/schedule.py") == everything
        assert changed_by("engines/reference/truth.py") == everything
        assert changed_by("engines/registry.py") == everything
        assert changed_by("metrics/error.py") == everything
    finally:
        monkeypatch.undo()
        source_fingerprint._adapters.cache_clear()  # noqa: SLF001
        fingerprint.cache_clear()


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


def test_a_package_that_the_engine_needs_is_part_of_the_key(
    brief: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, needs in (
        ("mujoco", "jax_like>=1"),
        ("jax_like", "jaxlib-like"),
        ("jaxlib_like", ""),
    ):
        metadata = tmp_path / f"{name}-4.0.dist-info" / "METADATA"
        metadata.parent.mkdir()
        lines = ["Metadata-Version: 2.4", f"Name: {name.replace('_', '-')}", "Version: 4.0"]
        lines += [f"Requires-Dist: {needs}"] if needs else []
        metadata.write_text("\n".join(lines) + "\n", encoding="utf-8")
    case = Case(scene=brief, engine="mujoco", timestep=1e-3)

    def key() -> str:
        versions_behind.cache_clear()
        return case_key(case)

    own = key()
    monkeypatch.syspath_prepend(tmp_path)
    before = key()
    metadata.write_text(metadata.read_text().replace("4.0", "4.1"), encoding="utf-8")
    assert len({own, before, key()}) == 3
    versions_behind.cache_clear()


def test_what_another_program_made_is_out_of_date(brief: Scene) -> None:
    told = case_metadata(Case(scene=brief, engine="mujoco"), "harness.evaluation.case_record")
    assert is_current(told)
    assert not is_current(replace(told, code="another"))
    assert not is_current(replace(told, engine_version="0.1"))
    assert not is_current(replace(told, engine="no longer there"))
