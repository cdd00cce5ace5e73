"""A comparison of many engines still reads at a glance: matrices, and curves of the best runs."""

from collections.abc import Sequence
from dataclasses import replace

import pytest

from harness.core.provenance import provenance
from harness.core.report_model import Figure, Prose, Replay, Table
from harness.core.verdict import Status
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import turn_error
from harness.report.layout import Section
from harness.report.scorecard import derived
from harness.report.tables import records
from harness.studies.comparison import selection, study
from harness.studies.comparison.selection import MANY, drawn_runs
from harness.studies.comparison.study import comparison_report
from harness.studies.comparison.suite import Unsupported
from tests.support.evaluations import evaluated

STEPS = (1e-3, 7e-4, 5e-4, 3e-4, 2e-4, 1.5e-4, 1.2e-4, 1e-4)
"""Timesteps of eight engines, each farther from the truth than the next."""

NAMES = [f"engine-{number}" for number in range(len(STEPS))]


def renamed(e: Evaluation, name: str, profile: str) -> Evaluation:
    """Return a run as that of another engine."""
    case = replace(e.simulation.case, engine=name, profile=profile, timestep=None, options=())
    return replace(e, simulation=replace(e.simulation, case=case))


@pytest.fixture(scope="module")
def runs() -> list[Evaluation]:
    """Return two runs of each engine: as it ships in long steps, and matched."""
    shipped = evaluated("gentle-rock", "mujoco", None, "default")
    return [
        each
        for name, step in zip(NAMES, STEPS, strict=True)
        for each in (
            renamed(shipped, name, "default"),
            renamed(evaluated("gentle-rock", "mujoco", step), name, "matched"),
        )
    ]


def labels(figures: Sequence[Figure]) -> list[set[str]]:
    return [{s.kind for panel in one.panels for s in panel.series} for one in figures]


def test_a_matrix_has_a_row_an_engine_and_a_column_a_scene(runs: list[Evaluation]) -> None:
    lacking = Unsupported(scene="tilted-plane", engine=NAMES[0], effects=("tilt",))
    tables = {a.name: a for a in comparison_report(runs, [lacking]) if isinstance(a, Table)}
    best, shipped = records(tables["best"]), records(tables["shipped"])
    assert [row["engine"] for row in best] == [row["engine"] for row in shipped] == NAMES
    errors = [abs(row["gentle-rock_deg"]) for row in best]
    assert errors[-1] < errors[0]
    assert best[-1]["gentle-rock_deg_verdict"].status is Status.AGREES
    assert best[-1]["gentle-rock_deg_case"] == runs[-1].simulation.digest
    assert len({row["gentle-rock_deg"] for row in shipped}) == 1
    assert best[0]["tilted-plane_rad_verdict"].status is Status.UNSUPPORTED


def test_of_many_engines_the_nearest_and_the_farthest_are_drawn(runs: list[Evaluation]) -> None:
    drawn = drawn_runs(runs)
    assert {e.simulation.case.profile for e in drawn} == {"matched"}
    sizes = [e.errors.phi_rms for e in drawn if e.errors]
    assert sizes == sorted(sizes)
    every = sorted(e.errors.phi_rms for e in runs if e.errors and e not in drawn)
    undrawn = {e.simulation.case.engine for e in runs} - {e.simulation.case.engine for e in drawn}
    assert len(drawn) + len(undrawn) == len(NAMES)
    assert undrawn
    assert sizes[0] < every[0]
    figures = [a for a in comparison_report(runs) if isinstance(a, Figure)]
    for kinds, figure in zip(labels(figures), figures, strict=True):
        assert not kinds & undrawn, figure.name
        assert all(name in figure.seen for name in undrawn), figure.name
    (replay,) = [a for a in comparison_report(runs) if isinstance(a, Replay)]
    assert {body.kind for body in replay.bodies} == {"reference"} | set(NAMES) - undrawn


def test_of_few_engines_every_profile_is_drawn(runs: list[Evaluation]) -> None:
    few = [e for e in runs if e.simulation.case.engine in NAMES[:MANY]]
    assert len(drawn_runs(few)) == len(few)


def test_the_summary_tells_the_nearest_and_the_farthest(runs: list[Evaluation]) -> None:
    (summary,) = [
        a for a in comparison_report(runs) if isinstance(a, Prose) and a.name == "summary"
    ]
    told = {name for name in NAMES if f"{name} matched" in summary.text}
    sizes = {e.simulation.case.engine: abs(turn_error(e) or 0.0) for e in runs[1::2]}
    assert told == {min(sizes, key=sizes.__getitem__), max(sizes, key=sizes.__getitem__)}


def test_a_constraint_is_ranked_with_no_contact(
    runs: list[Evaluation], monkeypatch: pytest.MonkeyPatch
) -> None:
    nearest = drawn_runs(runs)[0].simulation.case.engine
    for module in (selection, study):
        monkeypatch.setattr(module, "is_constraint", lambda name: name == nearest)
    assert nearest not in {e.simulation.case.engine for e in drawn_runs(runs)}
    texts = [a for a in comparison_report(runs) if isinstance(a, (Figure, Prose))]
    for each in texts:
        said = each.seen if isinstance(each, Figure) else each.text
        assert f"nearest is {nearest}" not in said.lower(), each.name
        assert f"smallest in {nearest}" not in said, each.name
    few = [e for e in runs if e.simulation.case.engine in {nearest, *NAMES[:MANY]}][: 2 * MANY]
    assert set(drawn_runs(few)) == set(few)


def test_the_headline_has_a_row_an_engine_at_its_best(runs: list[Evaluation]) -> None:
    chapter = Section(
        title="many", artefacts=comparison_report(runs), cases=(), provenance=provenance()
    )
    tables = {a.name: a for a in derived([chapter]) if isinstance(a, Table)}
    assert [row["engine"] for row in records(tables["engines"])] == NAMES
    assert all("matched" in row["settings"] for row in records(tables["engines"]))
    assert len(records(tables["gentle-rock-engines"])) == len(runs)
