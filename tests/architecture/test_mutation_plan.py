"""The plan of mutation testing names every module that judges, and tests that import it."""

from pathlib import Path

import pytest

from tests.mutation.plan import PACKAGES, Package, targets

ROOT = Path(__file__).parents[2]

JUDGES = (
    *("harness/metrics", "harness/gate", "harness/results", "harness/engines/stepping/schedule.py"),
    *("reference/integrable/brackets.py", "reference/integrable/turning_points.py"),
)


@pytest.fixture(autouse=True)
def _at_the_root(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)


def modules(place: str) -> set[Path]:
    path = Path(place)
    found = {path} if path.is_file() else set(path.rglob("*.py"))
    return {one for one in found if one.name != "__init__.py"}


def test_every_module_that_judges_is_mutated() -> None:
    expected = set().union(*map(modules, JUDGES))
    assert all(modules(place) for place in JUDGES)
    assert {target.path for target in targets()} == expected


def test_each_is_asked_of_tests_that_are_there() -> None:
    for target in targets():
        files = [ROOT / one.partition("::")[0] for one in target.tests]
        assert files
        assert all(one.is_file() for one in files)
        for one, file in zip(target.tests, files, strict=True):
            name = one.partition("::")[2]
            assert f"def {name}(" in file.read_text(encoding="utf-8") if name else True


@pytest.mark.parametrize("package", [one for one in PACKAGES if not one.only])
def test_each_module_has_tests_that_import_it(package: Package) -> None:
    for path in sorted(Path().glob(package.modules)):
        if path.name == "__init__.py":
            continue
        name = ".".join(path.with_suffix("").parts)
        files = Path(package.tests).glob("test_*.py")
        assert any(f"from {name} import" in one.read_text(encoding="utf-8") for one in files), name
