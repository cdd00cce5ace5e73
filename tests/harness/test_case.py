"""Cases: what no engine can run is refused; a digest names a case, and a command repeats it."""

import pickle
import shlex
from dataclasses import replace
from typing import Any

import pytest

from harness.core.case import Case
from harness.core.errors import HarnessError, InvalidSettingError
from models import Effects, Horizon, Scene, Slip


@pytest.fixture
def case(gentle: Scene) -> Case:
    """Return a case with every field set."""
    options = (("impratio", 10.0), ("cone", "elliptic"))
    return Case(scene=gentle, engine="mujoco", timestep=1e-4, options=options)


def test_options_are_sorted_so_that_their_order_does_not_matter(case: Case) -> None:
    assert case.options == (("cone", "elliptic"), ("impratio", 10.0))
    other = replace(case, options=case.options[::-1])
    assert other == case
    assert hash(other) == hash(case)
    assert other.digest("1") == case.digest("1")


def test_the_digest_stays_what_it_was(case: Case) -> None:
    # recorded; it may change only together with what a case says (its fields or its scene's),
    # because results that were stored under it are then no longer those of this case
    assert case.digest("4.0.0") == "f5bfd4bfa90a9e9e"


def test_the_digest_survives_pickling(case: Case) -> None:
    back = pickle.loads(pickle.dumps(case))  # noqa: S301 - our own bytes
    assert back == case
    assert back.digest("1") == case.digest("1")


@pytest.mark.parametrize(
    "change",
    [
        {"engine": "pybullet"},
        {"profile": "default"},
        {"timestep": 1.0000000000000002e-4},
        {"timestep": None},
        {"options": ()},
        {"options": (("cone", "pyramidal"), ("impratio", 10.0))},
        {"options": (("cone", "elliptic"), ("impratio", 10.000000000000002))},
    ],
    ids=str,
)
def test_the_digest_feels_every_field(case: Case, change: dict[str, Any]) -> None:
    other = replace(case, **change)
    assert other != case
    assert other.digest("1") != case.digest("1")


def test_the_digest_feels_the_engine_version(case: Case) -> None:
    assert case.digest("4.0.0") != case.digest("4.0.1")


def test_the_digest_feels_every_number_of_the_scene(case: Case) -> None:
    scene = case.scene
    others = [
        replace(scene, name="other"),
        replace(scene, cite="another source"),
        replace(scene, gravity=9.8),
        replace(scene, horizon=Horizon(bounces=2)),
        replace(scene, horizon=Horizon(seconds=1.0)),
        replace(scene, effects=Effects(slip=Slip(mu=0.3))),
        replace(scene, effects=Effects(slip=Slip(mu=0.0))),
    ]
    for name in ("mass", "radius", "half_height", "transverse_inertia", "axial_inertia"):
        # 1.5 keeps the axial moment below twice the transverse one
        value = 1.5 * getattr(scene.can, name)
        others.append(replace(scene, can=replace(scene.can, **{name: value})))
    for name in ("phi", "psi", "theta", "phi_dot", "psi_dot", "theta_dot"):
        value = getattr(scene.release, name) + 0.125
        others.append(replace(scene, release=replace(scene.release, **{name: value})))
    digests = {case.digest("1")} | {replace(case, scene=other).digest("1") for other in others}
    assert len(digests) == len(others) + 1


def test_equal_cases_have_equal_digests_whatever_kind_of_number_they_were_given(
    gentle: Scene,
) -> None:
    whole, real = (Case(scene=gentle, engine="mujoco", timestep=t) for t in (1, 1.0))
    assert whole == real
    assert whole.digest("1") == real.digest("1")


@pytest.mark.parametrize("timestep", [0.0, -1e-3, float("nan"), float("inf")])
def test_a_timestep_that_is_no_step_is_refused(gentle: Scene, timestep: float) -> None:
    with pytest.raises(InvalidSettingError) as caught:
        Case(scene=gentle, engine="mujoco", timestep=timestep)
    assert caught.value.name == "timestep"
    assert caught.value.value is timestep


def test_an_unknown_profile_is_refused_with_those_there_are(gentle: Scene) -> None:
    with pytest.raises(InvalidSettingError) as caught:
        Case(scene=gentle, engine="mujoco", profile="fast")
    assert (caught.value.name, caught.value.value) == ("profile", "fast")
    assert caught.value.allowed.startswith("default, matched")
    assert isinstance(caught.value, ValueError)
    assert isinstance(caught.value, HarnessError)


@pytest.mark.parametrize("timestep", [1e-4, 1.0 / 240.0, 0.1 + 0.2, 1e-9])
def test_the_command_states_the_timestep_to_its_last_digit(gentle: Scene, timestep: float) -> None:
    words = shlex.split(Case(scene=gentle, engine="mujoco", timestep=timestep).command())
    assert float(words[words.index("--timestep") + 1]) == timestep


def test_the_command_states_everything(case: Case) -> None:
    options = (("solref", (0.1 + 0.2, 1.0)), ("impratio", 1.0 / 3.0), ("cone", "elliptic"))
    case = replace(case, options=options, profile="default")
    assert shlex.split(case.command()) == [
        "rockingcan",
        "run",
        "gentle-rock",
        "--engine",
        "mujoco",
        "--profile",
        "default",
        "--timestep",
        "0.0001",
        "--set",
        "cone=elliptic",
        "--set",
        "impratio=0.3333333333333333",
        "--set",
        "solref=0.30000000000000004,1.0",
    ]


def test_the_label_tells_cases_apart(case: Case) -> None:
    assert case.label() == "gentle-rock mujoco matched dt=0.0001 cone=elliptic impratio=10.0"
    assert replace(case, options=(), timestep=None).label() == "gentle-rock mujoco matched"
