"""`rockingcan engines add`, `list` and `remove`: what they make, list, refuse and leave behind."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from importlib.metadata import EntryPoint, version
from pathlib import Path

import psutil
import pytest
from typer.main import get_group

from harness import api
from harness.cli.environments import environments
from harness.core.case import Case
from harness.core.engine_packages import EnginePackages, packages_of
from harness.core.environments import (
    RESERVED,
    SUBCOMMANDS,
    VARIABLE,
    environment,
    environment_names,
    environments_folder,
    path_of,
)
from harness.core.errors import ReservedNameError
from harness.engines import make_environment, new_environment, registry
from harness.engines.make_environment import NewEnvironment, UnmadeEnvironmentError
from harness.engines.new_environment import add_environment
from harness.engines.remote import RemoteEngine, call_at_engine
from harness.evaluation.evaluate import evaluate
from models import Scene
from tests.support.command_line import Command
from tests.support.environments import bare_environment, described, packages_here

pytestmark = pytest.mark.engine("mujoco")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Return a folder of environments that is not there yet."""
    monkeypatch.setenv(VARIABLE, str(tmp_path / "engines"))
    monkeypatch.setenv("PIP_NO_INDEX", "1")  # nothing is fetched, unless a test says so
    registry.forget_engines()
    yield tmp_path / "engines"
    registry.forget_engines()


def test_an_engine_is_added_listed_shown_and_removed(
    rockingcan: Command, folder: Path, tmp_path: Path
) -> None:
    added = rockingcan("engines", "add", "mujoco", "--interpreter", sys.executable)
    short = registry.engine("mujoco").version.removesuffix(".0")
    name = f"mujoco-{short}"
    assert (added.code, added.err) == (0, "")
    assert added.out.startswith(f"added '{name}': python {sys.version_info.major}.")
    assert environment_names() == (name,)
    assert registry.description_of(name).label == f"MuJoCo {short}"

    (listed,) = json.loads(rockingcan("engines", "list", "--json").out)["environments"]
    assert (listed["name"], listed["engine"], listed["state"]) == (name, "mujoco", "ok")
    assert listed["interpreter"] == sys.executable
    shown = {one["name"]: one for one in json.loads(rockingcan("engines", "--json").out)["engines"]}
    assert shown[name]["environment"]["mujoco"] == registry.engine("mujoco").version
    assert shown["mujoco"]["environment"] is None
    assert f"Settings of {name}" in rockingcan("engines", name).out
    run = rockingcan(
        "run", "gentle-rock", "--engine", name, "--timestep", "1e-3", "--set", "cone=pyramidal"
    )
    assert (run.code, run.err) == (0, "")

    again = rockingcan("engines", "add", "mujoco", "--interpreter", sys.executable)
    assert (again.code, again.err) == (0, "")
    assert again.out.startswith(f"kept '{name}': python {sys.version_info.major}.")
    other = bare_environment(tmp_path / "other", packages_here())
    beside = rockingcan("engines", "add", "mujoco", "--interpreter", other)
    assert beside.code == 2
    assert f"'{name}' is taken" in beside.err
    assert rockingcan("engines", "remove", name).out == f"removed '{name}'\n"
    assert environment_names() == ()
    assert Path(sys.executable).exists()
    assert list(folder.iterdir()) == []
    assert f"unknown engine '{name}'" in rockingcan("engines", name).err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nope"], "unknown engine 'nope'"),
        (["reference"], "an engine with packages of its own"),
        (["mujoco", "--python", "python9.99"], "a Python on the path, such as python3.12"),
        (["mujoco", "--interpreter", "/bin/true"], "'--interpreter' cannot be '/bin/true'"),
        (["mujoco", "--version", "newest"], "a version of the engine's package"),
        (["mujoco", "--name", "a b"], "letters, digits"),
        (["mujoco", "--name", "../x"], "letters, digits"),
        (["mujoco", "--name", "x" * 300], "at most 100 letters"),
        (["mujoco", "--name", "list"], "a word of the command line"),
        (["mujoco", "--name", "all"], "a word of the command line"),
        (["mujoco", "--name", "pybullet"], "'pybullet' is taken"),
        (["mujoco", "--wheel", "mujoco.zip"], "a file NAME-VERSION-...whl"),
        (["mujoco", "--wheel", "mujoco-9.0-py3-none-any.whl"], "a file that exists"),
        (["mujoco", "--version", "4.0", "--interpreter", "python3"], "nothing beside"),
        (["mujoco", "--interpreter", "python3", "--wheel", "x.whl"], "nothing beside --interp"),
        (["mujoco", "--version", "4.0", "--wheel", "x.whl"], "nothing beside --wheel"),
    ],
    ids=lambda words: " ".join(words) if isinstance(words, list) else "",
)
def test_what_cannot_be_added_is_one_sentence(
    rockingcan: Command, folder: Path, words: list[str], said: str
) -> None:
    refused = rockingcan("engines", "add", *words)
    assert refused.code == 2
    assert said in refused.err
    assert len(refused.err.splitlines()) == 1
    assert not folder.exists() or list(folder.iterdir()) == []


def test_wheels_are_of_the_engine_and_of_what_it_needs(rockingcan: Command, tmp_path: Path) -> None:
    needed = tmp_path / "mujoco_core-9.0-py3-none-any.whl"
    needed.touch()
    alone = rockingcan("engines", "add", "mujoco", "--wheel", str(needed))
    assert "a wheel of mujoco, and beside it those of what it needs" in alone.err
    engine = tmp_path / "mujoco-9.0-py3-none-any.whl"
    new = NewEnvironment(engine="mujoco", name="mine", wheels=(needed, engine))
    wanted = make_environment._wanted(new, registry.entry_of("mujoco"), "3.11.7")  # noqa: SLF001 - what pip is told
    assert wanted == [f"mujoco @ {engine.as_uri()}", f"mujoco-core @ {needed.as_uri()}"]
    assert new.command() == (
        f"rockingcan engines add mujoco --name mine --wheel {needed} --wheel {engine}"
    )


def test_pip_says_in_a_line_what_it_cannot_install(rockingcan: Command, folder: Path) -> None:
    refused = rockingcan("engines", "add", "mujoco", "--version", "0.0.1")
    assert refused.code == 2
    first, last = refused.err.splitlines()
    assert first.startswith("mujoco==0.0.1 for Python 3.")
    assert last.startswith("rockingcan: no environment is made for engine 'mujoco': pip cannot")
    assert "No matching distribution found for" in last
    assert list(folder.iterdir()) == []


def test_an_interpreter_without_the_engine_is_refused_with_what_it_needs(
    rockingcan: Command, tmp_path: Path, folder: Path
) -> None:
    python = bare_environment(tmp_path / "there", [])
    refused = rockingcan("engines", "add", "mujoco", "--interpreter", python)
    assert refused.code == 2
    assert "the engine does not answer (ModuleNotFoundError" in refused.err
    assert f"{python} -m pip install" in refused.err
    assert "numpy" in refused.err
    assert "pybullet" not in refused.err
    assert list(folder.iterdir()) == []


def no_pip(
    install: Callable[[str], None],
) -> Callable[..., "subprocess.CompletedProcess[str]"]:
    """Return a stand-in for the programs that are run, of which pip is a function of its target."""
    run = make_environment._run  # noqa: SLF001 - where programs are run

    def stand_in(words: list[str]) -> "subprocess.CompletedProcess[str]":
        if "--python" not in words:
            return run(words)
        install(words[words.index("--python") + 1])
        return subprocess.CompletedProcess(words, 0, "", "")

    return stand_in


def see_packages(python: str) -> None:
    """Have the environment of an interpreter see the packages of the tests."""
    (site,) = Path(python).parents[1].glob("lib/python*/site-packages")
    (site / "of_the_tests.pth").write_text("".join(f"{path}\n" for path in packages_here()))


def test_an_environment_is_made_with_the_program_that_runs(
    monkeypatch: pytest.MonkeyPatch, folder: Path
) -> None:
    monkeypatch.setattr(make_environment, "_run", no_pip(see_packages))
    said: list[str] = []
    made = add_environment(NewEnvironment(engine="mujoco", name="mine"), said.append)
    assert [word.split()[0] for word in said] == ["mujoco>=3.2"]
    assert {path.name for path in folder.iterdir()} == {Path(made.folder).name, "mine.json"}
    assert Path(made.interpreter).is_relative_to(made.folder)
    assert environment("mine") == made
    assert registry.engine("mine").version == registry.engine("mujoco").version
    new_environment.remove_environment("mine")
    assert list(folder.iterdir()) == []


def test_what_pip_started_ends_with_a_program_that_is_interrupted(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    told = tmp_path / "told"
    program = (
        "import subprocess, sys\n"
        "inner = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(100)'])\n"
        f"open({str(told)!r}, 'w').write(f'{{inner.pid}}\\n')\n"
        "inner.wait()\n"
    )

    def interrupted(_: object) -> None:
        while not told.exists() or not told.read_text().endswith("\n"):
            time.sleep(0.01)
        raise KeyboardInterrupt

    monkeypatch.setattr(subprocess.Popen, "communicate", interrupted)
    with pytest.raises(KeyboardInterrupt):
        make_environment._run([sys.executable, "-c", program])  # noqa: SLF001 - where programs are run
    inner = int(told.read_text())
    until = time.monotonic() + 10.0
    while psutil.pid_exists(inner) and psutil.Process(inner).status() != psutil.STATUS_ZOMBIE:
        assert time.monotonic() < until
        time.sleep(0.01)


def test_a_half_made_environment_is_never_listed(
    monkeypatch: pytest.MonkeyPatch, folder: Path
) -> None:
    def interrupted(python: str) -> None:
        assert Path(python).exists()
        assert environment_names() == ()
        raise KeyboardInterrupt

    monkeypatch.setattr(make_environment, "_run", no_pip(interrupted))
    with pytest.raises(KeyboardInterrupt):
        add_environment(NewEnvironment(engine="mujoco", name="mine"), lambda _: None)
    assert list(folder.iterdir()) == []


def test_of_two_programs_that_add_a_name_one_does(
    monkeypatch: pytest.MonkeyPatch, folder: Path
) -> None:
    def overtaken(python: str) -> None:
        see_packages(python)
        described("mine", "other:Engine", sys.executable)

    monkeypatch.setattr(make_environment, "_run", no_pip(overtaken))
    with pytest.raises(UnmadeEnvironmentError, match="'mine' is taken"):
        add_environment(NewEnvironment(engine="mujoco", name="mine"), lambda _: None)
    assert [path.name for path in folder.iterdir()] == ["mine.json"]
    left = environment("mine")
    assert left is not None
    assert left.entry == "other:Engine"


def test_a_broken_environment_is_listed_as_such_and_can_be_removed(
    rockingcan: Command, folder: Path
) -> None:
    described("gone", "harness.engines.mujoco:MujocoEngine", "/nowhere/python", command="AGAIN")
    path_of("torn").write_text('{"name": ', encoding="utf-8")
    listed = json.loads(rockingcan("engines", "list", "--json").out)["environments"]
    states = {one["name"]: one["state"] for one in listed}
    assert states["gone"].endswith("run: rockingcan engines remove gone && AGAIN")
    assert "describes no environment" in states["torn"]
    table = rockingcan("engines")
    assert table.code == 0
    shown = {one["name"]: one for one in json.loads(rockingcan("engines", "--json").out)["engines"]}
    assert shown["gone"]["broken"]
    assert shown["torn"]["broken"]
    assert shown["mujoco"]["installed"]
    run = rockingcan("run", "gentle-rock", "--engine", "gone")
    assert (run.code, len(run.err.splitlines())) == (2, 1)
    for name in states:
        assert rockingcan("engines", "remove", name).code == 0
    assert list(folder.iterdir()) == []
    unknown = rockingcan("engines", "remove", "gone")
    assert (unknown.code, unknown.err) == (
        2,
        "rockingcan: no engine 'gone' lives in an environment; there are: none\n",
    )


@pytest.mark.parametrize("name", sorted(RESERVED))
def test_words_of_the_command_are_no_names_of_engines(
    monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    entry = EntryPoint(name=name, value="mine:Engine", group="rockingcan.engines")
    monkeypatch.setattr(registry, "_entries", lambda: {name: entry})
    with pytest.raises(ReservedNameError) as caught:
        registry.engine(name)
    assert f"no engine can be called '{name}'" in str(caught.value)
    assert "'mine:Engine' under another name" in str(caught.value)


def test_the_commands_below_engines_are_those_that_are_parsed_as_such() -> None:
    assert set(get_group(environments).commands) == SUBCOMMANDS


def test_an_environment_whose_adapter_is_gone_is_listed_like_any_other(rockingcan: Command) -> None:
    described("orphan", "harness.engines.mujoco:MujocoEngine", sys.executable, engine="gone")
    table = rockingcan("engines")
    assert (table.code, table.err) == (0, "")
    shown = {one["name"]: one for one in json.loads(rockingcan("engines", "--json").out)["engines"]}
    assert (shown["orphan"]["installed"], shown["orphan"]["unsupported"]) == (True, "")
    assert shown["orphan"]["label"] == "gone (toy)"
    # nor does a description that goes round in a circle end the program
    described("orphan", "harness.engines.mujoco:MujocoEngine", sys.executable, engine="orphan")
    registry.forget_engines()
    assert registry.description_of("orphan").label == "orphan (toy)"


def test_a_name_stays_that_of_the_environment_whatever_is_registered_later() -> None:
    assert not isinstance(registry.engine("mujoco"), RemoteEngine)
    described("mujoco", "harness.engines.mujoco:MujocoEngine", sys.executable)
    registry.forget_engines()
    assert isinstance(registry.engine("mujoco"), RemoteEngine)
    assert call_at_engine("mujoco", os.getpid) != os.getpid()
    assert registry.description_of("mujoco").label.endswith("(toy)")
    assert "mujoco" in registry.installed()
    assert "mujoco" not in registry.adapter_names()


def test_an_engine_without_a_wheel_here_is_added_with_another_python(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    absent = EnginePackages(
        extra="rockingcan[mujoco]", needed=("nope",), optional=("nope",), elsewhere="3.11"
    )
    whole = packages_of
    monkeypatch.setattr(
        registry, "packages_of", lambda e: absent if e.name == "mujoco" else whole(e)
    )
    said = registry.how_to_add(["mujoco"])
    assert "to have it, run: rockingcan engines add mujoco --python python3.11 (or, with" in said
    assert "\n" not in said
    # once there is one elsewhere, it takes part in its place
    assert "mujoco" in registry.left_out()
    described("mujoco-4.0", "harness.engines.mujoco:MujocoEngine", sys.executable)
    registry.forget_engines()
    assert "mujoco" not in registry.left_out()
    assert registry.description_of("mujoco-4.0").by_default


def test_an_engine_that_was_removed_here_has_its_part_taken_by_its_environment(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    removed = EnginePackages(extra="rockingcan[mujoco]", needed=("nope",))
    whole = packages_of
    monkeypatch.setattr(
        registry, "packages_of", lambda e: removed if e.name == "mujoco" else whole(e)
    )
    # without one something is wrong with it: it takes part, and the run says so
    assert "mujoco" not in registry.not_installed()
    assert "mujoco" in api.stepping_engines(None)
    described("mujoco-4.0", "harness.engines.mujoco:MujocoEngine", sys.executable)
    registry.forget_engines()
    assert "mujoco" not in api.stepping_engines(None)
    assert "mujoco-4.0" in api.stepping_engines(None)
    assert "mujoco" not in api.absent_engines(None)


def test_versions_outside_of_what_an_adapter_supports_are_told(rockingcan: Command) -> None:
    place = described("old", "harness.engines.mujoco:MujocoEngine", sys.executable)
    assert registry.outside_range("mujoco") == registry.outside_range("old") == ""
    old = environments_folder() / "mujoco-3.1.dist-info"
    old.mkdir()
    (old / "METADATA").write_text("Metadata-Version: 2.1\nName: mujoco\nVersion: 3.1\n")
    text = path_of("old").read_text().replace(place.paths[0], str(environments_folder()))
    path_of("old").write_text(text)
    assert registry.outside_range("old") == "mujoco 3.1, which is not >=3.2"
    shown = json.loads(rockingcan("engines", "old", "--json").out)["engines"][0]
    assert shown["unsupported"] == "mujoco 3.1, which is not >=3.2"


@pytest.mark.slow
def test_a_wheel_is_installed_and_runs_with_the_bits_of_the_engine_here(
    rockingcan: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, brief: Scene
) -> None:
    monkeypatch.delenv("PIP_NO_INDEX")
    package = f"mujoco=={version('mujoco')}"
    pip = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--dest", str(tmp_path)]
    got = subprocess.run([*pip, package], capture_output=True, text=True, check=False)  # noqa: S603
    if got.returncode != 0:
        pytest.skip(f"no package index hands over {package}: an environment is not made for real")
    (wheel,) = tmp_path.glob("mujoco-*.whl")
    added = rockingcan("engines", "add", "mujoco", "--name", "build", "--wheel", str(wheel))
    assert (added.code, added.out.partition(":")[0]) == (0, "added 'build'")
    place = environment("build")
    assert place is not None
    assert Path(place.interpreter).is_relative_to(environments_folder())
    site = Path(place.interpreter).parents[1]
    assert not list(site.glob("lib/python*/site-packages/pybullet*"))  # no engine but this one
    assert not list(site.glob("lib/python*/site-packages/harness*"))  # nor a copy of the program
    here, there = (evaluate(Case(scene=brief, engine=name)) for name in ("mujoco", "build"))
    assert here.simulation.trajectory is not None
    assert there.simulation.trajectory is not None
    first, second = here.simulation.trajectory, there.simulation.trajectory
    assert first.position.tobytes() == second.position.tobytes()
    assert first.contact_force.tobytes() == second.contact_force.tobytes()
    assert rockingcan("engines", "remove", "build").code == 0
    assert not site.exists()
