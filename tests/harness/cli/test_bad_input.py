"""Bad input: one clear message on standard error, exit code 2, no traceback, nothing written."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from harness import api
from harness.engines import registry
from models import names
from tests.support.command_line import (
    INSTALLED,
    WRONG_USE,
    Command,
    able,
    is_one_clear_message,
)

BY_DEFAULT = ", ".join(api.stepping_engines(None))


# each: the line of the scene file that is replaced, what replaces it, what the message must name
SCENE_FAULTS = {
    "a word for a number": ("mass", 'mass = "heavy"', ("mass", "heavy")),
    "a negative mass": ("mass", "mass = -0.043", ("mass", "-0.043", "greater than")),
    "no mass at all": ("mass", "", ("mass", "missing")),
    "a key that is none": ("mass", "mass = 0.043\nmas = 1.0", ("mas",)),
    "a misspelt key": ("mass", "mas = 0.043", ("'can.mas' is unknown", "'mass'", "allowed are")),
    "NaN": ("radius", "radius = nan", ("radius", "nan")),
    "infinity": ("gravity", "gravity = inf", ("gravity", "inf")),
    "both A and a": ("A", "A = 4.2796308999999987e-05\na = 0.727", ("'can.A'", "'can.a'")),
    "neither A nor a": ("A", "", ("'can.A'", "'can.a'")),
    "moments of no rigid body": ("C", "C = 9e-05", ("2A", "9e-05")),
    "phi of zero": ("phi =", "phi = 0.0", ("phi", "pi/2")),
    "phi past a right angle": ("phi =", "phi = 1.6", ("phi", "pi/2")),
    "no bounce": ("bounces", "bounces = 0", ("bounces",)),
    "half a bounce": ("bounces", "bounces = 0.5", ("bounces",)),
    "two horizons": ("bounces", "bounces = 1\nseconds = 1.0", ("bounces", "seconds")),
    "an unknown effect": ("[effects]", "[effects.wind]\nspeed = 1.0", ("wind",)),
    "a negative friction": ("[effects]", "[effects.slip]\nmu = -0.1", ("mu", "-0.1")),
    "no TOML": ("mass", "mass = = 1", ("TOML",)),
}


@pytest.mark.parametrize("fault", SCENE_FAULTS)
def test_a_faulty_scene_file_is_refused_by_file_and_key(
    rockingcan: Command, scene_file: Callable[..., Path], fault: str
) -> None:
    old, new, parts = SCENE_FAULTS[fault]
    path = scene_file((old, new))
    answer = rockingcan("run", str(path), "--engine", "mujoco")
    is_one_clear_message(answer, str(path), *parts)


@pytest.mark.parametrize("command", ["reference", "run", "export"])
def test_every_command_refuses_a_faulty_scene(
    rockingcan: Command, scene_file: Callable[..., Path], command: str
) -> None:
    more = {"reference": (), "run": ("--engine", "mujoco"), "export": ("--format", "mjcf")}
    path = scene_file(("mass", "mass = -1.0"))
    is_one_clear_message(rockingcan(command, str(path), *more[command]), str(path), "mass")
    is_one_clear_message(rockingcan(command, "rolling-stone", *more[command]), *names())


def test_a_scene_file_that_is_not_there_is_named(rockingcan: Command, tmp_path: Path) -> None:
    path = tmp_path / "nothing.toml"
    is_one_clear_message(rockingcan("reference", str(path)), str(path))
    is_one_clear_message(rockingcan("reference", str(tmp_path)), str(tmp_path))


def test_an_unknown_engine_is_answered_with_those_there_are(rockingcan: Command) -> None:
    for words in (
        ("run", "gentle-rock", "--engine", "chrono"),
        ("engines", "chrono"),
        ("validate", "--engine", "chrono"),
    ):
        is_one_clear_message(rockingcan(*words), "'chrono'", "mujoco", "pybullet", "reference")


@pytest.mark.parametrize("timestep", ["0", "-1e-3", "nan", "inf"])
def test_a_timestep_that_is_none_is_refused(rockingcan: Command, timestep: str) -> None:
    answer = rockingcan("run", "gentle-rock", "--engine", "mujoco", "--timestep", timestep)
    is_one_clear_message(answer, "timestep", "a positive number of seconds")


@pytest.mark.parametrize(
    ("words", "parts"),
    [
        (("--timestep", "soon"), ("timestep", "number")),
        (("--profile", "best"), ("'best'", "default, matched")),
        (("--set", "glue=1"), ("'glue'", "impratio")),
        (("--set", "impratio"), ("KEY=VALUE",)),
        (("--set", "impratio=high"), ("impratio",)),
        (("--set", "cone=round"), ("cone", "elliptic")),
        (("--set", "impratio=1", "--set", "impratio=2"), ("impratio", "twice")),
        (("--set", "condim=2"), ("condim",)),
        (("--sett", "condim=2"), ("--sett",)),
        (("--out", "motion.xlsx"), ("motion.xlsx", ".csv or .parquet")),
    ],
    ids=str,
)
def test_a_faulty_option_is_named_with_what_is_allowed(
    rockingcan: Command, words: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    is_one_clear_message(rockingcan("run", "gentle-rock", "--engine", "mujoco", *words), *parts)


@pytest.mark.parametrize(
    "words",
    [
        ("reference", "gentle-rock", "--model", "wishful"),
        ("reference", "gentle-rock", "--method", "Euler1768"),
        ("reference", "gentle-rock", "--rtol", "0"),
        ("run", "gentle-rock", "--engine", "reference", "--timestep", "1e-3"),
        ("run", "gentle-rock"),
        ("export", "gentle-rock", "--format", "gltf"),
        ("validate", "--suite", "endless"),
        ("validate", "--jobs", "0"),
        ("validate", "--engine", "reference"),
        ("dance",),
    ],
    ids=" ".join,
)
def test_other_wrong_use_is_refused(rockingcan: Command, words: tuple[str, ...]) -> None:
    is_one_clear_message(rockingcan(*words))


def test_figures_without_a_report_name_the_option_that_is_missing(rockingcan: Command) -> None:
    answer = rockingcan("effects", "gentle-rock", "--engine", "mujoco", "--figures")
    is_one_clear_message(answer, "rockingcan: --figures needs --out: ")


@pytest.mark.parametrize(
    ("words", "parts"),
    [
        (("--model", "bogus"), ("'model' cannot be 'bogus'", "auto, pendulum, frictionless")),
        (
            ("--method", "bogus"),
            ("'method' cannot be 'bogus'", "auto, half-period, picard-chebyshev"),
        ),
        (("--rtol", "2"), ("'rtol' cannot be 2.0", "greater than 0 and less than 1")),
        (("--model", "general", "--method", "RK45"), ("'method' cannot be 'RK45'", "auto")),
    ],
    ids=str,
)
def test_only_the_choice_of_the_reference_that_is_wrong_is_named(
    rockingcan: Command, words: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    is_one_clear_message(rockingcan("reference", "gentle-rock", *words), *parts)


@pytest.mark.parametrize(
    ("effect", "key", "value"),
    [
        ("drilling", "length", "9e-6"),
        ("rolling_resistance", "length", "9e-6"),
        ("slip", "mu", "9e-6"),
    ],
)
def test_an_effect_weaker_than_an_engine_takes_is_refused_naming_those_that_can(
    rockingcan: Command, scene_file: Callable[..., Path], effect: str, key: str, value: str
) -> None:
    path = scene_file(("[effects]", f"[effects.{effect}]\n{key} = {value}"))
    answer = rockingcan("run", str(path), "--engine", "mujoco")
    weak = [n for n in INSTALLED if f"{effect}.{key}" in registry.engine(n).capabilities.least]
    others = able(effect)
    for name in weak:
        others = others.replace(f"{name}, ", "")
    is_one_clear_message(answer, f"'effects.{effect}.{key}' = 9e-06", "1e-05 or more", others)


@pytest.mark.parametrize("ratio", ["0", "-1"])
def test_a_ratio_that_mujoco_does_not_have_is_refused(rockingcan: Command, ratio: str) -> None:
    words = ("run", "gentle-rock", "--engine", "mujoco", "--set", f"impratio={ratio}")
    is_one_clear_message(rockingcan(*words), "impratio", ratio, "greater than zero")


def test_a_setting_of_another_engine_is_refused_naming_whose_it_is(rockingcan: Command) -> None:
    answer = rockingcan("run", "gentle-rock", "--engine", "mujoco", "--set", "contactSlop=1")
    is_one_clear_message(answer, "'mujoco' has no setting 'contactSlop'", "one of pybullet")


def test_stability_judges_engines_that_take_steps(rockingcan: Command) -> None:
    answer = rockingcan("stability", "--engine", "reference")
    is_one_clear_message(answer, "'reference'", BY_DEFAULT, "engines that move a can by steps")
    bogus = rockingcan("stability", "--engine", "bogus")
    is_one_clear_message(bogus, f"'bogus'; there are: {', '.join(registry.names())}")


def test_a_misspelt_constant_of_an_effect_is_one_message(
    rockingcan: Command, scene_file: Callable[..., Path]
) -> None:
    path = scene_file(("[effects]", "[effects.slip]\nnu = 0.3"))
    answer = rockingcan("reference", str(path))
    is_one_clear_message(answer, "'effects.slip.nu' is unknown", "allowed are mu")
    assert "missing" not in answer.err


def test_of_several_faults_each_line_is_a_message_of_its_own(
    rockingcan: Command, scene_file: Callable[..., Path]
) -> None:
    path = scene_file(("[effects]", "[effects.compliance]\nstifness = 1e4\nx = 1.0"))
    answer = rockingcan("reference", str(path))
    assert answer.code == WRONG_USE
    lines = answer.err.splitlines()
    assert len(lines) == 2
    assert all(line.startswith(f"rockingcan: scene file '{path}'") for line in lines)


@pytest.mark.parametrize(
    ("scene", "model", "needed"),
    [
        ("gentle-rock", "pendulum", "rolling"),
        ("gentle-rock", "frictionless", "rolling"),
        ("slipping-rock", "rolling", "coulomb"),
        ("tilted-plane", "coulomb", "general"),
    ],
)
def test_a_model_too_small_is_refused_naming_the_smallest_that_carries_the_scene(
    rockingcan: Command, scene: str, model: str, needed: str
) -> None:
    is_one_clear_message(rockingcan("reference", scene, "--model", model), model, needed)


@pytest.mark.parametrize("place", ["below a file", "in no folder", "a folder"])
def test_an_output_that_cannot_be_written_is_refused_before_anything_runs(
    rockingcan: Command, tmp_path: Path, place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    (tmp_path / "folder.csv").mkdir()
    out = (
        tmp_path
        / {
            "below a file": "file/motion.csv",
            "in no folder": "nowhere/motion.csv",
            "a folder": "folder.csv",
        }[place]
    )
    before = sorted(tmp_path.rglob("*"))
    monkeypatch.setattr("harness.cli.motions.evaluate", lambda _: pytest.fail("it ran"))
    is_one_clear_message(
        rockingcan("run", "gentle-rock", "--engine", "mujoco", "--out", str(out)), str(out)
    )
    assert sorted(tmp_path.rglob("*")) == before


def test_a_report_that_cannot_be_written_is_refused_before_anything_runs(
    rockingcan: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    monkeypatch.setattr(
        "harness.cli.validate.run_with_progress", lambda *_, **__: pytest.fail("it ran")
    )
    before = sorted(tmp_path.rglob("*"))
    for out in (tmp_path / "file", tmp_path / "file" / "report"):
        is_one_clear_message(rockingcan("validate", "--out", str(out)), str(out))
    assert sorted(tmp_path.rglob("*")) == before
    assert (tmp_path / "file").read_text(encoding="utf-8") == "mine"


@dataclass(frozen=True)
class Missing:
    """An entry point whose package is not installed."""

    name: str = "mujoco"
    value: str = "harness.engines.mujoco:MujocoEngine"
    dist: None = None

    def load(self) -> object:
        """Fail as an import does."""
        raise ModuleNotFoundError("No module named 'mujoco'", name="mujoco")


def test_a_missing_engine_package_says_how_to_install_it(
    rockingcan: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    entries = registry._entries() | {"mujoco": Missing()}  # noqa: SLF001 - where they come in
    monkeypatch.setattr(registry, "_entries", lambda: entries)
    registry.engine.cache_clear()
    try:
        for words in (("run", "gentle-rock", "--engine", "mujoco"), ("validate",)):
            is_one_clear_message(rockingcan(*words), "'mujoco'", "pip install mujoco")
        assert rockingcan("engines").code == 0  # the list goes on without it
    finally:
        registry.engine.cache_clear()


@pytest.mark.engine("pybullet")
def test_as_a_process_of_its_own_too(
    rockingcan_process: Command, scene_file: Callable[..., Path]
) -> None:
    path = scene_file(("mass", "mass = -1.0"))
    is_one_clear_message(
        rockingcan_process("run", str(path), "--engine", "pybullet"), str(path), "mass"
    )
    is_one_clear_message(
        rockingcan_process("run", "gentle-rock", "--engine", "pybullet", "--timestep", "0"),
        "timestep",
    )


@pytest.mark.parametrize(
    ("words", "nearest"),
    [
        (("validte",), "validate"),
        (("reference", "gentel-rock"), "gentle-rock"),
        (("run", "gentle-rock", "--engine", "mujco"), "mujoco"),
        (("run", "gentle-rock", "--engine", "mujoco", "--profile", "matchd"), "matched"),
        (("run", "gentle-rock", "--engine", "mujoco", "--set", "impratoi=1"), "impratio"),
        (("run", "gentle-rock", "--engine", "mujoco", "--set", "cone=eliptic"), "elliptic"),
        (("validate", "--suite", "quik"), "quick"),
        (("engines", "pybulet"), "pybullet"),
    ],
)
def test_a_misspelt_name_is_answered_with_the_nearest(
    rockingcan: Command, words: tuple[str, ...], nearest: str
) -> None:
    is_one_clear_message(rockingcan(*words), f"id you mean '{nearest}'?")


def test_a_name_that_is_near_nothing_is_answered_with_all(rockingcan: Command) -> None:
    answer = rockingcan("run", "gentle-rock", "--engine", "zzz")
    is_one_clear_message(answer, "'zzz'; there are:", "mujoco")
    assert "did you mean" not in answer.err
