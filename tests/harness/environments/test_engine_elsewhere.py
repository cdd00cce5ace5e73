"""An engine in an interpreter of its own is an engine like any other: same bits, same reports."""

import os
import pickle
import shutil
import sys
from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from harness.core.case import Case
from harness.core.environments import VARIABLE, Environment, environment, path_of
from harness.core.errors import HarnessError, InvalidSettingError, UnknownSettingError
from harness.core.provenance import provenance
from harness.core.simulation import Outcome, Simulation
from harness.core.trajectory import Trajectory
from harness.engines import registry, remote
from harness.engines.base import features_of, resolve
from harness.engines.conformance import ClauseStatus, conform
from harness.engines.make_environment import NewEnvironment
from harness.engines.new_environment import add_environment
from harness.engines.probes import measure
from harness.engines.remote import (
    BrokenEnvironmentError,
    OtherProgramError,
    RemoteEngine,
    WorldElsewhereError,
)
from harness.evaluation import timing
from harness.evaluation.case_cache import case_key, case_metadata, is_current
from harness.evaluation.case_record import measured
from harness.evaluation.evaluate import evaluate
from harness.evaluation.run_cases import run_cases
from harness.execution import worker
from harness.execution.estimate import processor_time
from harness.execution.isolated_pool import IsolatedProcessPool
from harness.execution.limits import Limits
from models import Scene
from tests.support.environments import bare_environment, described, packages_here, planted

ELSEWHERE = "mujoco-elsewhere"

pytestmark = pytest.mark.engine("mujoco")


@pytest.fixture(scope="module")
def elsewhere(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Environment]:
    """Add MuJoCo in the interpreter of the tests as an engine of its own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(VARIABLE, str(tmp_path_factory.mktemp("engines")))
        new = NewEnvironment(engine="mujoco", name=ELSEWHERE, interpreter=sys.executable)
        yield add_environment(new, lambda _: None)
        registry.forget_engines()


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Return an empty folder of environments."""
    monkeypatch.setenv(VARIABLE, str(tmp_path / "engines"))
    registry.forget_engines()
    yield tmp_path / "engines"
    registry.forget_engines()


def bits(simulation: Simulation) -> list[object]:
    """Return what a simulation has but its times, arrays as bytes."""
    path = simulation.trajectory
    assert path is not None
    arrays = [getattr(path, field.name).tobytes() for field in fields(Trajectory)]
    plain = (simulation.outcome, simulation.steps, simulation.settings, simulation.parity)
    return [*arrays, *plain, simulation.timestep, simulation.engine_version]


# ---- the same engine


def test_it_is_listed_with_a_name_and_a_label_of_its_own(elsewhere: Environment) -> None:
    assert ELSEWHERE in registry.names()
    assert ELSEWHERE not in registry.adapter_names()
    here, there = registry.engine("mujoco"), registry.engine(ELSEWHERE)
    assert isinstance(there, RemoteEngine)
    assert (there.name, there.version) == (ELSEWHERE, here.version)
    assert there.capabilities == here.capabilities
    label, said = registry.description_of("mujoco").label, registry.description_of(ELSEWHERE)
    assert said.label == f"{label} ({ELSEWHERE})"
    assert not said.by_default
    assert registry.variants(ELSEWHERE) == registry.variants("mujoco")
    mine, its = features_of(here), features_of(there)
    assert its.model_differences == mine.model_differences
    assert its.solver_efforts == mine.solver_efforts
    for feature in fields(mine):
        assert (getattr(mine, feature.name) is None) == (getattr(its, feature.name) is None)
    assert elsewhere.versions()["python"] == ".".join(map(str, sys.version_info[:3]))


@pytest.mark.parametrize("profile", ["default", "matched", "adaptive"])
def test_a_run_has_the_bits_of_the_engine_here(
    elsewhere: Environment, brief: Scene, profile: str
) -> None:
    here = evaluate(Case(scene=brief, engine="mujoco", profile=profile)).simulation
    case = Case(scene=brief, engine=elsewhere.name, profile=profile)
    there = evaluate(case).simulation
    assert there.case == case
    assert there.model == elsewhere.name
    assert bits(there) == bits(here)


def test_settings_that_go_with_the_timestep_are_asked_of_the_engine(
    elsewhere: Environment, brief: Scene
) -> None:
    case = Case(scene=brief, engine=elsewhere.name, timestep=1e-3)
    chosen = registry.engine(elsewhere.name)
    assert registry.timestep_of(case) == 1e-3
    assert resolve(case, chosen.settings, 1e-3)["solref"] == (2e-3, 1.0)
    assert pickle.loads(pickle.dumps(chosen.settings)) == chosen.settings  # noqa: S301 - made here
    with pytest.raises(UnknownSettingError, match=f"engine '{ELSEWHERE}' has no setting 'nope'"):
        evaluate(replace(case, options=(("nope", 1.0),)))
    with pytest.raises(InvalidSettingError, match="impratio"):
        evaluate(replace(case, options=(("impratio", -1.0),)))


@pytest.mark.slow
def test_settings_probes_counts_and_times_are_of_the_engine_there(
    elsewhere: Environment, brief: Scene
) -> None:
    here, there = (
        Case(scene=brief, engine=name, timestep=1e-3) for name in ("mujoco", elsewhere.name)
    )
    assert registry.export_settings(there) == registry.export_settings(here)
    assert measured(there)["solver_iterations"] == measured(here)["solver_iterations"] > 0.0
    assert measure(there).findings == measure(here).findings
    before = processor_time()
    assert len(timing.time_alone(there)["cpu_s"]) >= timing.FEWEST
    assert processor_time() > before
    assert set(timing.overhead(there)["ways"]) == set(timing.overhead(here)["ways"])
    many = features_of(registry.engine(elsewhere.name)).simulate_many
    assert many is not None
    assert [bits(run) for run in many([there, there])] == [bits(evaluate(here).simulation)] * 2
    with pytest.raises(WorldElsewhereError, match="call_at_engine"):
        features_of(registry.engine(elsewhere.name)).open(there)  # type: ignore[misc]


def test_processes_with_limits_give_the_same_bits(elsewhere: Environment, brief: Scene) -> None:
    cases = [Case(scene=brief, engine=name) for name in ("mujoco", elsewhere.name)]
    with IsolatedProcessPool(2, Limits(seconds=100.0)) as executor:
        here, there = run_cases(cases, executor)
    assert bits(here.simulation) == bits(there.simulation)
    assert repr(here.errors) == repr(there.errors)  # what is no number is equal, too


@pytest.mark.slow
def test_it_keeps_the_contract(elsewhere: Environment) -> None:
    looked: list[str] = []
    here, there = (
        conform(registry.engine("mujoco")),
        conform(registry.engine(elsewhere.name), looked.append),
    )
    assert [(v.name, v.result, v.number) for v in there] == [
        (v.name, v.result, v.number) for v in here
    ]
    assert looked == [verdict.name for verdict in there]
    assert ClauseStatus.FAILED not in {verdict.result for verdict in there}


# ---- what is kept of it


def test_the_key_of_a_result_goes_with_what_is_installed_there(
    elsewhere: Environment, brief: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = Case(scene=brief, engine=elsewhere.name)
    key, metadata = case_key(case), case_metadata(case)
    assert is_current(metadata)
    assert key == case_key(case) != case_key(replace(case, engine="mujoco"))
    monkeypatch.setattr(Environment, "versions", lambda _: {"python": "3.99.0"})
    assert case_key(case) != key
    assert not is_current(metadata)


def plant(site: Path, name: str, build: str, *needs: str) -> None:
    """Plant the metadata of a package of version 9.9 whose file has a digest of this name."""
    info = site / f"{name}-9.9.dist-info"
    info.mkdir(parents=True)
    words = ["Metadata-Version: 2.1", f"Name: {name}", "Version: 9.9"]
    words += [f"Requires-Dist: {need}" for need in needs]
    (info / "METADATA").write_text("\n".join(words) + "\n")
    placed = (
        f"../../../bin/{name},sha256={site.name},1\n{info.name}/INSTALLER,sha256={site.name},1\n"
    )
    (info / "RECORD").write_text(f"{placed}{name}/__init__.py,sha256={build},1\n")


@pytest.mark.usefixtures("folder")
def test_builds_of_one_version_differ_and_places_do_not(tmp_path: Path) -> None:
    builds = {
        "one": ("a", "b", "c"),
        "same": ("a", "b", "c"),
        "other": ("z", "b", "c"),
        "needs": ("a", "z", "c"),
        "unasked": ("a", "b", "z"),
    }
    prints = {}
    for place, (engine, core, extra) in builds.items():
        site = tmp_path / place
        plant(site, "mujoco", engine, "mujoco-core<10,>=9", "more; extra == 'more'", "nowhere")
        plant(site, "mujoco_core", core, "mujoco")
        plant(site, "more", extra)
        there = replace(described(place, "a:B", sys.executable), paths=(str(site),))
        assert there.versions() == {"python": there.python, "mujoco": "9.9"}
        prints[place] = there.fingerprint()
    assert prints["one"] == prints["same"] == prints["unasked"]
    assert len(set(prints.values())) == 3


@pytest.mark.usefixtures("folder")
def test_a_file_without_a_digest_counts_by_size_and_time(tmp_path: Path) -> None:
    plant(tmp_path / "site", "mujoco", "a")
    site = tmp_path / "site"
    with (site / "mujoco-9.9.dist-info" / "RECORD").open("a") as record:
        record.write("mujoco/lib.so,,\nmujoco/__pycache__/__init__.pyc,,\nmujoco/gone.py,,\n")
    (site / "mujoco" / "__pycache__").mkdir(parents=True)
    library, compiled = (site / "mujoco" / name for name in ("lib.so", "__pycache__/__init__.pyc"))
    there = replace(described("there", "a:B", sys.executable), paths=(str(site),))
    prints = []
    for file, content, changed in ((library, "a", 1), (library, "bc", 1), (library, "bc", 2)):
        file.write_text(content)
        os.utime(file, (changed, changed))
        prints.append(there.fingerprint())
    assert len(set(prints)) == 3
    compiled.touch()
    assert there.fingerprint() == prints[-1]


def test_provenance_has_its_python_and_packages(elsewhere: Environment) -> None:
    told = provenance()
    assert told.environments[elsewhere.name] == str(elsewhere)
    assert f"python {elsewhere.python}, mujoco " in told.to_dict()["environments"][elsewhere.name]


# ---- what goes wrong


TOY = """
from dataclasses import replace
from harness.engines import Capabilities, Simulation
class Toy:
    name, version, settings = "toy", "1.2", ()
    capabilities = Capabilities(honours=frozenset(), imposes={{}})
    def timestep(self, case):
        return 1e-3
    def simulate(self, case):
        import os, signal, time
        {body}
"""


@pytest.fixture
def toy(request: pytest.FixtureRequest, tmp_path: Path, folder: Path) -> str:
    """Plant an engine of another package where its interpreter alone finds it; return its name."""
    del folder
    return planted(tmp_path, TOY.format(body=request.param)).name


@pytest.mark.parametrize(
    ("toy", "outcome", "note"),
    [
        ("os.kill(os.getpid(), signal.SIGSEGV)", Outcome.CRASHED, "SIGSEGV"),
        ("raise OSError('no disk')", Outcome.BROKEN, "`simulate` raised OSError: no disk"),
        ("return 3", Outcome.BROKEN, "`simulate` returned int"),
    ],
    indirect=["toy"],
)
def test_an_engine_that_fails_there_fails_as_here(
    toy: str, outcome: Outcome, note: str, brief: Scene
) -> None:
    case = Case(scene=brief, engine=toy)
    with IsolatedProcessPool(1, Limits(seconds=100.0)) as executor:
        (there,) = run_cases([case], executor)
    for done in (there, evaluate(case)):
        assert done.simulation.outcome is outcome
        assert note in done.simulation.note
        assert done.simulation.engine_version == "1.2"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("toy", "limits", "outcome"),
    [
        ("time.sleep(1000)", Limits(seconds=4.0), Outcome.HUNG),
        ("x = b'1' * 2**30; time.sleep(1000)", Limits(memory=0.7 * 2**30), Outcome.OUT_OF_MEMORY),
    ],
    indirect=["toy"],
)
def test_limits_hold_for_the_interpreter_of_an_engine(
    toy: str, limits: Limits, outcome: Outcome, brief: Scene
) -> None:
    with IsolatedProcessPool(1, limits) as executor:
        (done,) = run_cases([Case(scene=brief, engine=toy)], executor)
    assert done.simulation.outcome is outcome


def test_a_worker_of_another_version_of_the_program_is_refused(
    elsewhere: Environment, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(worker, "sources_fingerprint", lambda: "0123456789abcdef")
    place = replace(
        elsewhere, command="rockingcan engines add"
    )  # so that it has a worker of its own
    with pytest.raises(OtherProgramError) as caught:
        RemoteEngine(place, registry.engine, 60.0)
    assert caught.value.engine == elsewhere.name
    assert caught.value.reason.endswith(", and here 0123456789abcdef")


def test_a_worker_runs_the_sources_of_this_program_whatever_is_installed_there(
    tmp_path: Path, folder: Path
) -> None:
    del folder
    (tmp_path / "old" / "harness").mkdir(parents=True)
    (tmp_path / "old" / "harness" / "__init__.py").write_text("raise ImportError('an old copy')")
    python = bare_environment(tmp_path / "there", [str(tmp_path / "old"), *packages_here()])
    place = described("mujoco-there", registry.entry_of("mujoco").value, python)
    found = registry.engine(place.name)
    assert found.version == registry.engine("mujoco").version


def test_an_interpreter_that_is_gone_is_one_sentence(tmp_path: Path, folder: Path) -> None:
    del folder
    python = bare_environment(tmp_path / "there", packages_here())
    described("mujoco-there", registry.entry_of("mujoco").value, python, command="COMMAND")
    shutil.rmtree(tmp_path / "there")
    with pytest.raises(BrokenEnvironmentError) as caught:
        registry.engine("mujoco-there")
    said = str(caught.value)
    assert "the environment of engine 'mujoco-there' is broken" in said
    assert "No such file" in said
    assert said.endswith("run: rockingcan engines remove mujoco-there && COMMAND")
    assert "\n" not in said


def test_an_interpreter_without_the_packages_is_one_sentence(
    tmp_path: Path, folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    del folder
    entry = registry.entry_of("mujoco").value
    described("nothing", entry, bare_environment(tmp_path / "nothing", []))
    with pytest.raises(BrokenEnvironmentError, match=r"ModuleNotFoundError: No module named"):
        registry.engine("nothing")
    (tmp_path / "broken" / "mujoco").mkdir(parents=True)
    (tmp_path / "broken" / "mujoco" / "__init__.py").write_text("raise ImportError('wrong CPU')")
    paths = [str(tmp_path / "broken"), *packages_here()]
    described("broken", entry, bare_environment(tmp_path / "there", paths))
    with pytest.raises(BrokenEnvironmentError, match="wrong CPU"):
        registry.engine("broken")
    assert capfd.readouterr() == ("", "")


def test_a_description_that_cannot_be_read_is_one_sentence(folder: Path, brief: Scene) -> None:
    folder.mkdir()
    path_of("mine").write_text("{}", encoding="utf-8")
    assert "mine" in registry.names()
    with pytest.raises(HarnessError, match="rockingcan engines remove mine"):
        evaluate(Case(scene=brief, engine="mine"))
    assert registry.description_of("mine").label == ""
    assert provenance().environments == {}


def test_the_environment_of_a_worker_is_here_for_it(elsewhere: Environment) -> None:
    found = remote.call_at_engine(elsewhere.name, environment, elsewhere.name)
    assert found is None
    assert environment(elsewhere.name) == elsewhere
    assert np.isfinite(processor_time())
