"""A ladder of timesteps, or of the accuracies of an engine that chooses its own steps."""

from dataclasses import replace

import pytest

from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.core.simulation import Outcome, Simulation
from harness.engines import ladder
from harness.engines.description import Description
from harness.evaluation.evaluate import check_case
from harness.studies.comparison.selection import finest, label
from harness.studies.comparison.suite import SUITES, suite_cases
from models import Scene, load
from tests.support.evaluations import evaluated

OWN_STEPS = Description(accuracy_setting="tol", accuracies=(1e-2, 1e-3, 1e-4, 1e-5))


@pytest.fixture(autouse=True)
def _described(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the engine `free` choose its own steps."""
    described = {"free": OWN_STEPS}
    monkeypatch.setattr(ladder, "description_of", lambda name: described.get(name, Description()))


def test_what_chooses_its_steps_is_run_at_its_finest_accuracies(gentle: Scene) -> None:
    timesteps = (1e-3, 1e-4, 1e-5)
    assert ladder.rungs("free", timesteps) == (1e-3, 1e-4, 1e-5)
    assert ladder.rungs("free", timesteps[:1]) == (1e-5,)
    assert ladder.rungs("other", timesteps[:2]) == timesteps[:2]
    case = Case(scene=gentle, engine="free", options=(("k", 2.0),))
    at = ladder.at_rung(case, 1e-4)
    assert (at.timestep, dict(at.options)) == (None, {"k": 2.0, "tol": 1e-4})
    assert ladder.rung_of(at) == 1e-4
    assert ladder.rung_of(case) is None
    stepping = ladder.at_rung(replace(case, engine="other"), 1e-4)
    assert (stepping.timestep, ladder.rung_of(stepping)) == (1e-4, 1e-4)


def test_a_run_says_how_fine_it_was(gentle: Scene) -> None:
    def run(engine: str, timestep: float | None, **settings: float) -> Simulation:
        return Simulation(
            case=Case(scene=gentle, engine=engine),
            outcome=Outcome.FINISHED,
            trajectory=None,
            engine_version="1",
            model="",
            timestep=timestep,
            settings=settings,
        )

    assert ladder.fineness(run("free", None, tol=1e-7)) == 1e-7
    assert ladder.rung_words(run("free", None, tol=1e-7)) == "tol 1e-07"
    assert ladder.rung_words(run("other", 1e-4)) == "0.0001 s"
    assert ladder.rung_words(run("other", None)) == ""


def test_a_suite_asks_it_for_accuracies_and_no_adaptive_profile(gentle: Scene) -> None:
    scenes = {name: load(name) for name in SUITES["quick"]}
    cases = suite_cases("quick", ["free", "other"], scenes)
    own = [case for case in cases if case.engine == "free"]
    assert {case.profile for case in own} == {"default", "matched"}
    assert {case.timestep for case in own} == {None}
    rungs = [dict(c.options) for c in own if c.scene.name == "gentle-rock" and c.options]
    assert rungs == [{"tol": value} for value in OWN_STEPS.accuracies]
    assert {c.profile for c in cases if c.engine == "other"} == {"default", "matched", "adaptive"}
    assert gentle.name in scenes


def test_what_chooses_its_steps_has_no_profile_that_does(
    gentle: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    described = {"pybullet": OWN_STEPS}
    monkeypatch.setattr(ladder, "description_of", lambda name: described.get(name, Description()))
    check_case(Case(scene=gentle, engine="mujoco", profile="adaptive"))
    check_case(Case(scene=gentle, engine="pybullet", profile="default"))
    with pytest.raises(InvalidSettingError, match="'pybullet' chooses its own steps") as refused:
        check_case(Case(scene=gentle, engine="pybullet", profile="adaptive"))
    assert "mujoco" in refused.value.allowed


def test_the_finest_run_is_drawn_and_called_by_its_accuracy(gentle: Scene) -> None:
    stepped = evaluated(gentle, "mujoco", 1e-3)
    runs = [
        replace(
            stepped,
            simulation=replace(
                stepped.simulation,
                case=Case(scene=gentle, engine="free", options=(("tol", value),)),
                timestep=None,
                settings={"tol": value},
            ),
        )
        for value in (1e-3, 1e-5)
    ]
    (chosen,) = finest(runs)
    assert chosen is runs[1]
    assert label(chosen) == "free, matched, tol 1e-05"
