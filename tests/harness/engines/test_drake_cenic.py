"""Drake with error control: its accuracy, its own steps, and settings to paste."""

import math
from typing import Any

import numpy as np
import pytest

from harness.cli.main import code_of
from harness.core.case import Case, Value
from harness.core.errors import InvalidSettingError
from harness.core.simulation import Simulation
from harness.engines.ladder import rung_of
from harness.engines.registry import description_of, engine, export_settings, timestep_of
from harness.engines.stepping.physics_engine import ErrorControlledEngine
from harness.studies.cost.design import plan_cost
from harness.studies.errors.plan import plan_errors
from harness.studies.shared.ablation import ablation_path
from harness.studies.stability.limits import next_round
from harness.studies.stability.suite import SUITES, ladder, stability_cases
from models import Scene, load
from models.rim import released
from tests.support.evaluations import turn_error

pytestmark = pytest.mark.engine("drake-cenic")

NAME = "drake-cenic"


def case_of(scene: Scene, accuracy: float | None = None, **options: Value) -> Case:
    """Return a matched case at an accuracy."""
    chosen: dict[str, Value] = {} if accuracy is None else {"accuracy": accuracy}
    chosen |= options
    return Case(scene=scene, engine=NAME, options=tuple(chosen.items()))


@pytest.mark.parametrize(
    ("accuracy", "most"),
    [(1e-5, 0.2), (1e-7, 0.02), pytest.param(1e-8, 0.005, marks=pytest.mark.slow)],
)
def test_the_gentle_release_turns_better_the_finer_the_accuracy(
    gentle: Scene, accuracy: float, most: float
) -> None:
    assert abs(turn_error(case_of(gentle, accuracy))) < most


def test_the_paper_release_turns_at_the_matched_accuracy_and_not_on_a_half_space() -> None:
    case = case_of(load("paper-release"))
    assert abs(turn_error(case)) < 0.01
    assert abs(turn_error(case_of(load("paper-release"), ground="HalfSpace"))) > 10.0


def brief_run(brief: Scene, accuracy: float) -> Simulation:
    """Return a run of 20 ms."""
    found = engine(NAME).simulate(case_of(brief, accuracy))
    assert found.trajectory is not None
    return found


def test_its_own_steps_are_recorded_and_end_at_the_horizon(brief: Scene) -> None:
    found = brief_run(brief, 1e-6)
    path = found.trajectory
    assert path is not None
    assert found.timestep is None
    assert path.time[0] == 0.0
    assert path.time[-1] == brief.horizon.seconds
    assert len(set(np.diff(path.time).round(9))) > 3
    # the force is the one that changed the momentum; the last sample has that of the last step
    gained = brief.can.mass * np.diff(path.velocity[:, 2]) / np.diff(path.time)
    assert len(path) == found.steps
    weight = brief.can.mass * brief.gravity
    np.testing.assert_allclose(path.contact_force[:-1, 2], gained + weight, atol=1e-12 * weight)
    assert path.contact_force[-1].tolist() == path.contact_force[-2].tolist()


def test_how_a_run_is_cut_into_chunks_changes_no_step(brief: Scene) -> None:
    chosen: Any = engine(NAME)
    ends = []
    for most in (1, 7, 10**6):
        world = chosen.open(case_of(brief, 1e-6))
        world.place(*released(brief))
        steps = list[Any]()
        while not steps or not steps[-1].ended:
            steps.append(world.advance(0.02, most))
        times = np.concatenate([each.times for each in steps])
        assert len(times) == len(set(times))
        ends.append((times.tolist(), steps[-1].states[-1].tolist()))
    assert ends[0] == ends[1] == ends[2]


def test_a_state_that_is_placed_is_where_the_next_step_begins(brief: Scene) -> None:
    chosen: Any = engine(NAME)
    world = chosen.open(case_of(brief, 1e-6))
    pose, twist = released(brief)
    world.place(pose, twist)
    world.step()
    once = world.pose().position.tolist()
    for _ in range(3):
        world.step()
    world.place(pose, twist)
    world.step()
    assert world.pose().position.tolist() == once


def test_a_finer_accuracy_takes_more_steps(brief: Scene) -> None:
    counts = [brief_run(brief, value).steps for value in (1e-4, 1e-5, 1e-6, 1e-7)]
    assert counts == sorted(set(counts))


def test_what_it_ships_with_is_what_is_stated() -> None:
    from pydrake.systems.analysis import SimulatorConfig  # noqa: PLC0415 - may not be installed

    stated = {setting.name: setting.default for setting in engine(NAME).settings}
    shipped = SimulatorConfig()
    assert (shipped.accuracy, shipped.max_step_size) == (
        stated["accuracy"],
        stated["max_step_size"],
    )
    for name in ("stiction_tolerance", "point_stiffness", "hunt_crossley_dissipation", "ground"):
        discrete = {setting.name: setting.default for setting in engine("drake").settings}
        assert stated[name] == discrete[name]


def test_what_is_pasted_runs_and_means_the_case(gentle: Scene) -> None:
    names = dict[str, Any]()
    exec(compile(export_settings(case_of(gentle, 1e-5)), "pasted", "exec"), names)  # noqa: S102 - a user would
    names["plant"].Finalize()
    assert names["plant"].time_step() == 0.0
    config = names["simulator_config"]
    assert (config.integration_scheme, config.accuracy, config.max_step_size) == (
        "cenic",
        1e-5,
        0.01,
    )
    assert names["material"]().GetProperty("material", "point_contact_stiffness") == 1e12


def test_a_timestep_is_refused_with_the_setting_that_stands_in_its_place(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert code_of(["run", "gentle-rock", "--engine", NAME, "--timestep", "1e-3"]) == 2
    said = capsys.readouterr().err
    assert len(said.strip().splitlines()) == 1
    assert "accuracy" in said
    assert description_of(NAME).accuracy_setting == "accuracy"


def test_steps_of_the_probes_are_a_thousandth_of_the_natural_time(gentle: Scene) -> None:
    chosen = engine(NAME)
    assert isinstance(chosen, ErrorControlledEngine)
    case = case_of(gentle)
    assert chosen.open(case).timestep == pytest.approx(
        1e-3 * math.sqrt(gentle.can.radius / gentle.gravity)
    )
    assert timestep_of(case) is None


def test_every_study_has_a_ladder_of_accuracies_in_the_place_of_timesteps(gentle: Scene) -> None:
    accuracies = description_of(NAME).accuracies
    errors = plan_errors(gentle, NAME)
    assert errors.rungs == accuracies[-5:]
    assert errors.at_probe == "accuracy 1e-06"
    path = ablation_path(gentle, NAME)
    assert path.names == ("ground", "spring", "accuracy")
    assert path.finest == "accuracy 1e-08"
    cost = plan_cost(gentle, load("paper-release"), [NAME], hard_scene=load("paper-release"))
    hardest = [family for hard in cost.hardness for family in hard.families]
    assert {family.name for family in hardest} == {"own steps"}
    assert all(family.steps for family in (*cost.scored, *cost.tuning, *hardest))
    suite = SUITES["quick"]
    stability = stability_cases(suite, [NAME])
    scene = load("tall-can")
    assert ladder(suite, scene, NAME) == accuracies[-len(ladder(suite, scene)) :]
    searched = next_round(suite, [NAME], {})
    for cases in (errors.cases(), path.cases(), cost.cases(), stability, searched):
        assert {case.timestep for case in cases} == {None}
        assert "adaptive" not in {case.profile for case in cases}
        assert {dict(case.options).get("accuracy") for case in cases} <= {None, *accuracies}
    assert all(rung_of(case) == accuracies[-1] for case in searched)


def test_a_study_that_is_given_a_timestep_says_what_stands_in_its_place(gentle: Scene) -> None:
    for plan in (plan_errors, ablation_path):
        with pytest.raises(InvalidSettingError, match="by its setting 'accuracy'"):
            plan(gentle, NAME, timestep=1e-3)


def test_a_tilt_is_rolled_on_as_it_ships() -> None:
    shipped = Case(scene=load("tilted-plane"), engine=NAME, profile="default")
    rows = {row.quantity: row for row in engine(NAME).parity(shipped)}  # type: ignore[attr-defined]
    assert "mismatch" not in {row.verdict for row in rows.values()}
    kept = rows["speed kept"]
    assert kept.found == pytest.approx(kept.declared, rel=1e-8)
