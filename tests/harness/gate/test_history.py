"""A history of releases: what changed between which, and what becomes of those that do not run."""

from dataclasses import replace

import pytest
from packaging.version import Version

from harness.core.case import Case, Value
from harness.core.errors import InvalidSettingError
from harness.core.report_model import Figure, Prose, Table
from harness.gate.history import study as history_study
from harness.gate.history.runs import RunRow, run_case
from harness.gate.history.study import HistoryStudy, _designed
from harness.gate.history.tables import change_points
from harness.results.plausibility import objections
from harness.studies.comparison.study import ComparisonStudy, plan_comparison
from harness.studies.study import Work, run_study
from models import load
from tests.support.toy_releases import TIMESTEPS, ToyReleases, lost

COARSE, FINE = TIMESTEPS


def deeper_from(version: str) -> "ToyReleases":
    """Return releases whose contact at the coarse timestep is three times as deep from one on."""

    def depth(own: Version, case: Case) -> float:
        changed = own >= Version(version) and case.timestep == COARSE
        return 3e-6 if changed else 1e-6

    return ToyReleases(depth=depth)


def told(study: HistoryStudy) -> str:
    """Return the words of the report of a history."""
    words = study.report(run_study(study))[0]
    assert isinstance(words, Prose)
    return words.text


def test_a_change_is_named_with_its_releases_its_case_and_its_factor() -> None:
    study = deeper_from("1.5").study("1.0", "1.4", "1.5", "1.8")
    done = run_study(study)
    words, figure, points, changes, versions = study.report(done)
    assert isinstance(words, Prose)
    assert isinstance(figure, Figure)
    assert isinstance(points, Table)
    assert isinstance(changes, Table)
    assert isinstance(versions, Table)
    (point,) = points.frame.to_dict("records")
    assert (point["to_version"], point["cases"], point["factor"]) == ("1.5", 1, 3.0)
    (row,) = changes.frame.to_dict("records")
    assert (row["from_version"], row["to_version"], row["between"]) == ("1.4", "1.5", 0)
    assert (row["scene"], row["profile"], row["timestep_s"]) == ("gentle-rock", "matched", COARSE)
    assert (row["quantity"], row["before"], row["after"]) == ("max_penetration_m", 1e-6, 3e-6)
    assert row["tolerance"] == 1e-9  # no spread, and a nanometre
    assert "Between 1.4 and 1.5: 1 quantity of 1 case changed." in words.text
    assert "by a factor of 3, from 1e-06 m to 3e-06 m" in words.text
    (panel,) = figure.panels
    assert panel.series[0].label == "gentle-rock matched at 0.001 s"
    assert words.title.endswith("the history of toy with softness 1.0")
    assert panel.x_names == ("1.0", "1.4", "1.5", "1.8")
    assert panel.series[0].y.tolist() == [1.0, 1.0, 3.0, 3.0]
    assert versions.frame["outcome"].tolist() == ["ran"] * 4
    assert versions.frame["quantities"].tolist() == [2] * 4
    assert study.made(done) == ("toy-1.0", "toy-1.4", "toy-1.5", "toy-1.8")


def test_a_gap_is_told_and_bisecting_closes_it_with_the_case_that_changed() -> None:
    toys = deeper_from("1.5")
    study = toys.study("1.0", "1.8")
    (change,) = study.changes(run_study(study))
    assert change.between == tuple(f"1.{n}" for n in range(1, 8))
    assert "(7 releases between the two were not run)" in told(study)

    toys.ran.clear()
    study = toys.study("1.0", "1.8", bisect=True)
    done = run_study(study)
    (change,) = study.changes(done)
    assert (change.before, change.after, change.between) == ("1.4", "1.5", ())
    between = [(version, step) for version, step in toys.ran if version not in {"1.0", "1.8"}]
    assert {step for _, step in between} == {COARSE}
    assert len(between) == 3  # of seven releases: halved thrice
    outcomes = study.report(done)[4]
    assert isinstance(outcomes, Table)
    assert outcomes.frame["outcome"].tolist().count("ran cases that changed") == 3


def test_bisecting_passes_by_releases_that_cannot_be_installed_or_run() -> None:
    toys = deeper_from("1.5")
    toys.absent, toys.refused = {"1.4": "no wheel"}, {"1.5": "the API is too old"}
    study = toys.study("1.0", "1.8", bisect=True)
    (change,) = study.changes(run_study(study))
    assert (change.before, change.after, change.between) == ("1.3", "1.6", ())


def test_a_release_that_is_not_there_or_does_not_run_is_a_row_with_the_reason() -> None:
    toys = deeper_from("1.5")
    toys.absent, toys.refused = {"1.0": "no wheel"}, {"1.8": "no sensor"}
    study = toys.study("1.0", "1.1", "1.2", "1.8")
    words, _, changes, versions = study.report(run_study(study))
    assert isinstance(words, Prose)
    assert isinstance(changes, Table)
    assert isinstance(versions, Table)
    rows = versions.frame.set_index("version")
    assert tuple(rows.loc["1.0", ["outcome", "reason"]]) == ("not installed", "no wheel")
    assert tuple(rows.loc["1.8", ["outcome", "refused", "reason"]]) == (
        "the adapter does not run it",
        2,
        "no sensor",
    )
    assert changes.frame.empty
    assert "2 of 4 releases, 1.1 to 1.2" in words.text
    assert "was measured in 1.2, and" in words.text
    assert "1.0 (not installed: no wheel)" in words.text
    assert "No quantity of any case changed" in words.text


def test_nothing_that_runs_is_a_report_too() -> None:
    toys = ToyReleases(depth=lambda *_: 1e-6, absent={"1.0": "no wheel", "1.8": "no wheel"})
    study = toys.study("1.0", "1.8", bisect=True)
    assert told(study).startswith("0 cases were run in 0 of 2 releases.")


def test_what_moves_by_less_than_four_spreads_is_no_change() -> None:
    def depth(version: Version, case: Case) -> float:
        if case.scene.name != "gentle-rock":
            return 1.5e-6  # of a perturbed release: half as much again
        return {Version("1.0"): 1e-6, Version("1.1"): 2.9e-6}.get(version, 1e-6)

    toys = ToyReleases(depth=depth)
    study = toys.study("1.0", "1.1", "1.2")
    assert study.changes(run_study(study)) == ()


def test_a_change_that_is_not_clear_is_measured_in_its_own_two_releases() -> None:
    """The newest release has a small spread, the one with the change a large one."""

    def depth(version: Version, case: Case) -> float:
        if version == Version("1.1"):
            return 3e-6 if case.scene.name == "gentle-rock" else 1e-6
        return 1e-6 if case.scene.name == "gentle-rock" else 1.1e-6

    toys = ToyReleases(depth=depth)
    study = toys.study("1.0", "1.1", "1.2", bisect=True)
    assert study.changes(run_study(study)) == ()
    # one that is clear stays, and nothing more is run of it
    toys.depth = lambda v, case: depth(v, case) * (10.0 if v == Version("1.1") else 1.0)
    changes = study.changes(run_study(study))
    assert [change.after for change in changes] == ["1.1", "1.1", "1.2", "1.2"]
    assert all(change.difference.tolerance == pytest.approx(4e-7 + 1e-9) for change in changes)


def test_changes_of_two_releases_are_one_point_with_the_largest() -> None:
    def depth(version: Version, case: Case) -> float:
        factor = 5.0 if case.timestep == FINE else 2.0
        return 1e-6 * (factor if version >= Version("1.2") else 1.0)

    study = ToyReleases(depth=depth).study("1.0", "1.1", "1.2")
    (point,) = change_points(study.changes(run_study(study)))
    assert (point.before, point.after, point.between) == ("1.1", "1.2", 0)
    assert (point.cases, point.quantities) == (2, 2)
    assert point.largest.identity.timestep == FINE
    assert point.largest.factor == 5.0


@pytest.mark.engine("mujoco")
@pytest.mark.parametrize("settings", [{}, {"impratio": 10.0}], ids=["as planned", "open"])
def test_what_is_published_holds_and_is_of_releases_that_ran_the_whole_suite(
    settings: dict[str, Value],
) -> None:
    cases = plan_comparison("quick", ("mujoco",), {"mujoco": settings}).cases

    def run(case: Case) -> RunRow:
        error = 1e-4 + abs(case.scene.release.psi)  # which moves from member to member
        row = {"digest": case.digest("1.0"), "truth_pulls": False, "phi_rms_rad": error}
        row |= {"max_slip_m_s": 1e-6, "steps": 1e6, "cpu_s": 1.0}
        reason = "no sensor" if (case.engine, case.profile) == ("mujoco-1.1", "default") else ""
        return RunRow(outcome="FINISHED", row=row, reason=reason, record={})

    toys = ToyReleases(depth=lambda *_: 1e-6)
    study = replace(
        toys.study("1.0", "1.1", "1.2"),
        engine="mujoco",
        settings=tuple(settings.items()),
        design=lambda name: tuple(
            replace(case, engine=name.replace("toy", "mujoco")) for case in cases
        ),
        running=Work(name="running", call=run, lost=lost, label=str),
    )
    done = run_study(study)
    assert list(study.results(done)) == ["1.0", "1.1", "1.2"]
    published = study.whole_results(done)
    assert list(published) == ["1.0", "1.2"]
    for result in published.values():
        assert len(result.cases) == len(cases)
        assert list(objections(result, {"mujoco": settings})) == []


def test_a_run_is_kept_as_its_row_or_as_the_reason_why_there_is_none() -> None:
    case = Case(scene=load("gentle-rock"), engine="reference", profile="matched")
    run = run_case(case)
    score = run.score(case)
    assert score is not None
    assert (score.outcome, score.finished, run.reason) == ("FINISHED", True, "")
    assert score.values["phi_rms_rad"] < 1e-9

    refused = run_case(replace(case, options=(("nonsense", 1.0),)))
    assert refused.score(case) is None
    assert "nonsense" in refused.reason
    assert refused.record["outcome"].startswith("broken")


def test_a_setting_that_the_suite_varies_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    own = Case(scene=load("gentle-rock"), engine="toy", options=(("accuracy", 1e-3),))
    plan = ComparisonStudy(suite="quick", designed=(own,), unsupported=(), settings={})
    monkeypatch.setattr(history_study, "plan_comparison", lambda *_: plan)
    assert _designed("quick", (), {"other": 1.0}, "toy") == plan.cases
    with pytest.raises(InvalidSettingError, match="what suite quick does not vary itself"):
        _designed("quick", (), {"accuracy": 1e-6}, "toy")
