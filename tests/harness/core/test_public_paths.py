"""The import paths that stay, and those of the previous release, which warn."""

import importlib
import importlib.util
import math
import sys
from types import SimpleNamespace

import pytest

import harness
import harness.engines
from harness.core.case import Case
from harness.core.public_paths import MOVED
from harness.engines import PhysicsEngine, base
from harness.engines.world import signed_distance
from models import Scene


@pytest.mark.parametrize("package", [harness, harness.engines])
def test_every_public_name_can_be_imported(package: object) -> None:
    names = package.__all__  # type: ignore[attr-defined]
    assert names == sorted(names, key=lambda name: (not name.isupper(), name.islower(), name))
    for name in names:
        assert getattr(package, name) is not None
        assert name in dir(package)


def test_a_name_that_is_not_there_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="'harness' has no attribute 'nothing'"):
        _ = harness.nothing


@pytest.mark.parametrize("old", sorted(MOVED))
def test_an_old_path_gives_the_new_module_and_warns(old: str) -> None:
    sys.modules.pop(old, None)
    new = importlib.import_module(MOVED[old])
    with pytest.warns(DeprecationWarning, match=f"'{old}' is now '{MOVED[old]}'"):
        found = importlib.import_module(old)
    sys.modules.pop(old)
    assert found is new
    assert new.__name__ == MOVED[old]
    assert new.__spec__ is not None
    assert new.__spec__.name == MOVED[old]


def test_the_engine_that_steps_worlds_warns_at_its_old_path() -> None:
    from harness.engines import stepping  # noqa: PLC0415 - what is tested

    with pytest.warns(DeprecationWarning, match=r"import 'PhysicsEngine' from 'harness\.engines'"):
        assert stepping.PhysicsEngine is harness.engines.PhysicsEngine


def test_no_old_path_is_a_module_of_its_own() -> None:
    assert [old for old in MOVED if importlib.util.find_spec(old.rpartition(".")[0]) is None] == []


def test_names_of_the_previous_release_are_accepted_with_a_warning() -> None:
    difference = base.ModelDifference(name="rim", settings=("margin",), sentence="It is round.")
    engine = SimpleNamespace(
        name="older", model_differences=(), gaps=(difference,), leanest=print, paste=str
    )
    with pytest.warns(
        DeprecationWarning, match=r"`(gaps|leanest|paste)` of older is now"
    ) as warned:
        features = base.features_of(engine)
    assert features == base.EngineFeatures(
        model_differences=(difference,), bare_loop=print, export_settings=str
    )
    assert len(warned) == 3
    world = SimpleNamespace(gap=lambda: 0.5)
    with pytest.warns(DeprecationWarning, match="`gap` of SimpleNamespace is now"):
        assert signed_distance(world) == 0.5
    with pytest.warns(DeprecationWarning, match="is now `SolverEffort`"):
        assert base.Effort is base.SolverEffort


def test_rows_imposed_by_default_are_accepted_under_their_old_name() -> None:
    rows = frozenset({"mass"})
    older = SimpleNamespace(name="older", imposed={}, imposed_by_default=rows)
    with pytest.warns(DeprecationWarning, match="`imposed_by_default` of older is now `imposed"):
        found = PhysicsEngine.imposed_rows(older)  # type: ignore[arg-type]
    assert found == {"default": rows}


def test_a_set_of_rows_excuses_any_deviation(gentle: Scene) -> None:
    older = SimpleNamespace(imposed_rows=lambda: {"default": frozenset({"mass"})})
    for profile, rows in (("default", {"mass": math.inf}), ("matched", {})):
        case = Case(scene=gentle, engine="older", profile=profile)
        assert PhysicsEngine.imposed_in(older, case) == rows  # type: ignore[arg-type]


def test_an_engine_with_nothing_optional_has_the_defaults() -> None:
    assert base.features_of(SimpleNamespace(name="bare")) == base.EngineFeatures()
