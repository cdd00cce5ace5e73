"""Engines whose packages need not be installed: listed, left out, refused where named."""

import json
import sys
from collections.abc import Callable, Iterator
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from harness import api
from harness.cli.main import code_of
from harness.cli.study_command import not_installed
from harness.core import engine_packages
from harness.core.engine_packages import ENGINE_ENTRY_POINTS, install_command, packages_of
from harness.core.errors import (
    BrokenPackageError,
    EngineCrashError,
    MissingPackageError,
    UnknownEngineError,
)
from harness.core.verdict import Status
from harness.engines import plugin_probe, registry
from harness.engines.description import Description
from harness.execution.isolated_pool import IsolatedProcessPool
from harness.execution.limits import Limits
from harness.gate.baseline import cases_of_absent, write_baseline
from harness.gate.comparison import differences
from harness.gate.report import GATE, regressions, sentences
from harness.results.files import read_scores
from harness.results.result import Result
from tests.support.gate_scores import make_score, make_scores

Register = Callable[..., None]

ADD = "pip install 'glider-kit[glider]'"


@pytest.fixture
def register(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Register]:
    """Return a function that installs a package which registers the engine `glider`.

    Its adapter imports the module of another package, `glide`, which is not installed.
    """

    def install(*requirements: str, extra: bool = True) -> None:
        metadata = tmp_path / "site" / "glider_kit-1.0.dist-info"
        metadata.mkdir(parents=True)
        lines = ["Metadata-Version: 2.4", "Name: glider-kit", "Version: 1.0"]
        lines += ["Provides-Extra: glider"] if extra else []
        lines += [f"Requires-Dist: {requirement}" for requirement in requirements]
        (metadata / "METADATA").write_text("\n".join(lines) + "\n", encoding="utf-8")
        entry = f"[{ENGINE_ENTRY_POINTS}]\nglider = glider_adapter:Glider\n"
        (metadata / "entry_points.txt").write_text(entry, encoding="utf-8")
        adapter = metadata.parent / "glider_adapter.py"
        adapter.write_text("import glide\n", encoding="utf-8")
        monkeypatch.syspath_prepend(metadata.parent)
        packages_of.cache_clear()

    # tried in a process of its own, which has nothing to say of a package that is not there
    monkeypatch.setattr(registry, "crash_reason", lambda _: "")
    registry.engine.cache_clear()
    yield install
    packages_of.cache_clear()
    registry.engine.cache_clear()


OPTIONAL = "glide-physics>=2; extra == 'glider'"


def packages() -> engine_packages.EnginePackages:
    """Return what is declared of the glider."""
    (entry,) = (e for e in entry_points(group=ENGINE_ENTRY_POINTS) if e.name == "glider")
    return packages_of(entry)


def test_the_package_that_has_the_version_of_an_engine_comes_first(register: Register) -> None:
    register("another; extra == 'glider'", "hang_glider>=2; extra == 'glider'", "numpy>=2")
    (entry,) = (e for e in entry_points(group=ENGINE_ENTRY_POINTS) if e.name == "glider")
    needed = [f"{one.name} {one.specifier}" for one in engine_packages.requirements_of(entry)]
    assert needed == ["hang_glider >=2", "another ", "glider-kit ==1.0"]


def test_an_extra_of_its_name_says_what_an_engine_needs(register: Register) -> None:
    register("numpy>=2", OPTIONAL, "Other.Thing; extra == 'glider'", "spare; extra == 'more'")
    declared = packages()
    assert declared.extra == "glider-kit[glider]"
    assert declared.needed == declared.optional == ("glide-physics", "other-thing")
    assert declared.missing == declared.optional
    assert "glider" in registry.left_out()


@pytest.mark.parametrize(
    ("requirements", "extra"),
    [
        (("glide-physics", OPTIONAL), True),  # part of every installation
        (("Glide_Physics; python_version > '3'", OPTIONAL), True),  # so too, in this Python
        (("numpy; extra == 'glider'",), True),  # optional, and installed
        ((), True),
        (("glide-physics",), False),
    ],
)
def test_an_engine_that_should_be_there_is_not_left_out(
    requirements: tuple[str, ...],
    extra: bool,  # noqa: FBT001 - of the parameters above
    register: Register,
) -> None:
    register(*requirements, extra=extra)
    assert not packages().missing
    assert "glider" not in registry.left_out()
    assert "glider" in api.stepping_engines(None)
    with pytest.raises(MissingPackageError) as caught:
        registry.engine("glider")
    assert (caught.value.part, caught.value.package) == ("engine 'glider'", "glide")


def test_a_package_that_another_python_depends_on_is_optional_in_this_one(
    register: Register,
) -> None:
    register("glide-physics; python_version < '3'", OPTIONAL)
    assert "glider" in registry.left_out()


def test_an_engine_that_is_left_out_takes_part_where_it_is_named(register: Register) -> None:
    register(OPTIONAL)
    assert "glider" in registry.names()
    assert "glider" not in api.stepping_engines(None)
    assert "mujoco" in api.stepping_engines(None)
    assert api.stepping_engines(["glider"]) == ("glider",)
    with pytest.raises(MissingPackageError) as caught:
        registry.engine("glider")
    assert caught.value.install.endswith("pip install 'glider-kit[glider]'")


@pytest.mark.parametrize(
    "words",
    [
        ("run", "gentle-rock"),
        ("validate",),
        ("attribute", "gentle-rock"),
        ("errors", "gentle-rock"),
        ("cost", "gentle-rock"),
        ("effects", "gentle-rock"),
        ("stability",),
        ("sweep", "gentle-rock", "--over", "release.phi=0.1:0.2:2", "--out", "out"),
        ("check",),
    ],
)
def test_to_ask_for_it_is_wrong_use(
    words: tuple[str, ...],
    register: Register,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    register(OPTIONAL)
    monkeypatch.chdir(tmp_path)
    named = ("glider",) if words == ("check",) else ("--engine", "glider")
    assert code_of([*words, *named]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("rockingcan: engine 'glider' needs the package 'glide', which ")
    assert said.err.endswith(f"{ADD}\n")
    assert said.err.count("\n") == 1


def test_engines_says_how_to_add_it(
    register: Register, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    register(OPTIONAL)
    monkeypatch.setenv("COLUMNS", "2000")
    assert code_of(["engines"]) == 0
    said = " ".join(capsys.readouterr().out.replace("│", " ").split())
    assert "glider not installed engine 'glider' needs the package 'glide'" in said
    assert ADD in said
    assert code_of(["engines", "--json"]) == 0
    told = {each["name"]: each for each in json.loads(capsys.readouterr().out)["engines"]}
    assert told["glider"]["installed"] is False
    assert told["glider"]["message"].endswith(ADD)


BROKEN = "raise ImportError('undefined symbol: glide_fast')\n"
"""What a wheel that was built for another library does when it is imported."""


def build(tmp_path: Path, module: str, source: str) -> None:
    """Install a build of the package behind an engine."""
    site = tmp_path / "site"
    metadata = site / f"{module.replace('_', '-')}-2.0.dist-info"
    metadata.mkdir(parents=True, exist_ok=True)
    (metadata / "METADATA").write_text(f"Metadata-Version: 2.4\nName: {module}\nVersion: 2.0\n")
    (metadata / "RECORD").write_text(f"{module}.py,{len(source)},\n")
    (site / f"{module}.py").write_text(source, encoding="utf-8")


@pytest.mark.parametrize("by_default", [True, False])
def test_one_that_is_installed_and_broken_is_listed_with_the_reason(
    by_default: bool,  # noqa: FBT001 - a parameter
    register: Register,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    register("glide; extra == 'glider'")
    build(tmp_path, "glide", BROKEN)
    described = Description(by_default=by_default)
    monkeypatch.setattr(
        api, "description_of", lambda n: described if n == "glider" else Description()
    )
    with pytest.raises(BrokenPackageError, match="undefined symbol: glide_fast"):
        registry.engine("glider")
    assert code_of(["engines", "--json"]) == 0
    told = {each["name"]: each for each in json.loads(capsys.readouterr().out)["engines"]}
    assert (told["glider"]["installed"], told["glider"]["broken"]) == (False, True)
    assert "undefined symbol: glide_fast" in told["glider"]["message"]
    # what takes part by default is not passed over
    assert ("glider" in api.stepping_engines(["all"])) is by_default
    assert ("glider" in api.absent_engines(["all"])) is not by_default
    said = [each.text for each in not_installed(api.absent_engines(["all"]))]
    assert any("undefined symbol: glide_fast" in text for text in said) is not by_default


def test_beside_all_a_name_is_of_an_engine(register: Register) -> None:
    register(OPTIONAL)
    with pytest.raises(UnknownEngineError):
        api.stepping_engines(["all", "nope"])
    with pytest.raises(MissingPackageError):
        api.stepping_engines(["glider", "all"])
    assert api.stepping_engines(["all", "reference"])[-1] == "reference"


def test_a_build_for_another_processor_is_tried_elsewhere_and_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "caches"))
    monkeypatch.syspath_prepend(tmp_path / "site")
    registry.engine.cache_clear()
    for known in [name for name in sys.modules if name.startswith("harness.engines.dart")]:
        monkeypatch.delitem(sys.modules, known)
    monkeypatch.delitem(sys.modules, "dartpy", raising=False)
    build(tmp_path, "dartpy", "import os, signal\n\nos.kill(os.getpid(), signal.SIGILL)\n")
    with pytest.raises(EngineCrashError, match="SIGILL, illegal instruction"):
        registry.engine("dart")
    build(tmp_path, "dartpy", BROKEN)  # it does no harm: this process may import it
    tried: list[int] = []

    class Counted(IsolatedProcessPool):
        def __init__(self, workers: int, limits: Limits) -> None:
            tried.append(workers)
            super().__init__(workers, limits)

    monkeypatch.setattr(plugin_probe, "IsolatedProcessPool", Counted)
    for _ in range(2):
        with pytest.raises(BrokenPackageError, match="undefined symbol"):
            registry.engine("dart")
    assert len(tried) == 1
    registry.engine.cache_clear()


@pytest.mark.parametrize("named", ["pip", "python", "elsewhere"])
def test_the_command_is_that_of_this_environment(
    named: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "an env" / "bin"
    folder.mkdir(parents=True)
    monkeypatch.setattr(sys, "executable", str(folder / "python"))
    pip = (folder if named == "pip" else tmp_path) / "pip"
    pip.write_text("#!/bin/sh\n", encoding="utf-8")
    pip.chmod(0o755)
    monkeypatch.setenv("PATH", str(pip.parent))
    if named == "elsewhere":
        monkeypatch.chdir("/")
    starts = {
        "pip": "pip",
        "python": "'an env/bin/python' -m pip",
        "elsewhere": f"{str(folder / 'python')[1:]!r} -m pip",
    }
    assert install_command(["numpy", "a[b]"]) == f"{starts[named]} install numpy 'a[b]'"


def accepted(*engines: str, place: str = "there") -> Result:
    """Return accepted results of two cases of each engine."""
    scores = [
        make_score({"phi_rms_rad": 1e-3}, engine=engine, timestep=timestep)
        for engine in engines
        for timestep in (1e-4, 0.5)  # the suite has the first of them
    ]
    return make_scores(*scores, place=place)


def test_its_accepted_results_are_not_measured_and_fail_nothing() -> None:
    both, run = accepted("mujoco", "glider"), accepted("mujoco", place="here")
    expected = (*run.scores, *cases_of_absent(both, "quick", ["glider"]))
    found = differences(both, run, expected=expected, not_installed=["glider"])
    (absent,) = (d for d in found if d.identity.engine == "glider")
    assert (absent.status, absent.note) == (Status.NOT_MEASURED, "glider is not installed")
    assert absent.identity.timestep == 1e-4
    assert regressions(found) == ()
    said = sentences(found, both, run, GATE)
    assert said[0].startswith("2 cases of here")
    assert "Not measured: 1 accepted case: glider is not installed." in said


def test_without_that_reason_a_case_that_is_gone_fails() -> None:
    found = differences(accepted("mujoco", "glider"), accepted("mujoco"))
    assert [d.status for d in regressions(found)] == [Status.MISSING] * 2


@pytest.mark.slow  # a dozen short runs, and two reports
def test_a_gate_goes_on_without_it_and_every_page_says_so(
    register: Register,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    for name in ("study", "suite"):  # modules by their full names, since a function has one of them
        module = sys.modules[f"harness.studies.comparison.{name}"]
        monkeypatch.setattr(module, "SUITES", {"quick": {"gentle-rock": (1e-3,)}})
    monkeypatch.setenv("COLUMNS", "400")
    before, after = tmp_path / "before", tmp_path / "after"
    assert code_of(["validate", "--engine", "mujoco", "--no-store", "--out", str(before)]) == 0
    assert "left out" not in capsys.readouterr().out  # of an engine that was not asked for
    own = read_scores(before)
    theirs = [score.model_copy(update={"engine": "glider"}) for score in own.cases]
    engines = dict.fromkeys(("mujoco", "glider"), own.engines["mujoco"])
    write_baseline(
        own.of_cases((*own.cases, *theirs)).model_copy(update={"engines": engines}), tmp_path
    )
    register(OPTIONAL)
    words = ["validate", "--no-store", "--out", str(after), "--baseline", str(tmp_path)]
    assert code_of(words) == 0
    page = (after / "summary.md").read_text(encoding="utf-8")
    for said in (capsys.readouterr().out, page):
        assert "Not measured: 3 accepted cases: glider is not installed." in said
        assert "Not installed, and so left out: glider" in said
        assert ADD in said.replace("\\", "")  # of Markdown
    assert "not measured" in (after / "junit.xml").read_text(encoding="utf-8")
