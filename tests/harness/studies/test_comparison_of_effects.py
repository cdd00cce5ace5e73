"""Scenes with effects in the comparison: a chaotic one, and one that an engine lacks."""

from collections.abc import Mapping
from dataclasses import replace

import pytest

from harness import api
from harness.core.case import Case
from harness.core.report_model import Artefact, Prose, Table
from harness.core.verdict import Verdict
from harness.engines.registry import missing_effects
from harness.evaluation.evaluation import Evaluation
from harness.studies.comparison import study
from harness.studies.comparison.study import comparison_report
from harness.studies.comparison.suite import Unsupported, split_unsupported, suite_cases
from models import Horizon, RoundedRim, Scene, load
from models.effects import modelling_choices
from tests.support.evaluations import evaluated

ENGINES = ("mujoco", "pybullet")
Found = Mapping[str, Artefact]


def rounded(gentle: Scene) -> Scene:
    """Return a scene whose rim MuJoCo does not have."""
    effects = replace(gentle.effects, rim=RoundedRim(radius=1e-3))
    return replace(gentle, name="rounded", effects=effects)


def verdicts(found: Found, table: str, column: str, **where: str) -> set[object]:
    frame = found[table].frame  # type: ignore[union-attr]
    for name, value in where.items():
        frame = frame[frame[name] == value]
    return {one.text if isinstance(one, Verdict) else one for one in frame[column]}


@pytest.fixture(scope="module")
def chaos() -> list[Evaluation]:
    """Return runs of the chaotic can, of which one falls over after it has parted."""
    return [evaluated("chaotic-can", name, 2e-4) for name in ENGINES]


def compared(*others: Evaluation) -> Found:
    """Return the report of runs beside those of a can that slips, which a toy cannot represent."""
    slipping = [evaluated("slipping-rock", name, 1e-3) for name in ENGINES]
    left_out = Unsupported(scene="slipping-rock", engine="toy", effects=("slip",))
    return {a.name: a for a in comparison_report([*others, *slipping], [left_out])}


@pytest.fixture(scope="module")
def found(chaos: list[Evaluation]) -> Found:
    return compared(*chaos)


@pytest.fixture(scope="module")
def slipping() -> Found:
    return compared()


def test_an_engine_is_not_asked_for_what_it_cannot_represent(gentle: Scene) -> None:
    round_ = rounded(gentle)
    cases = [Case(scene=scene, engine=name) for scene in (gentle, round_) for name in ENGINES]
    able, left_out = split_unsupported(cases)
    assert missing_effects("mujoco", round_) == ("rim",)
    assert able == (cases[0], cases[1], cases[3])
    assert left_out == (Unsupported(scene=round_.name, engine="mujoco", effects=("rim",)),)
    assert str(left_out[0].verdict) == "unsupported: cannot represent rim"


@pytest.mark.engine("pybullet")
def test_the_suite_leaves_it_out_of_the_run_and_says_so(
    gentle: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = replace(rounded(gentle), horizon=Horizon(seconds=0.02))
    monkeypatch.setattr(study, "SUITES", {"quick": {scene.name: (1e-3,)}})
    monkeypatch.setattr(study, "load", lambda _: scene)
    monkeypatch.setitem(suite_cases.__globals__, "SUITES", {"quick": {scene.name: (1e-3,)}})
    evaluations, artefacts = api.validate("quick")
    assert {e.simulation.case.engine for e in evaluations} == {"pybullet"}
    told = {a.name: a for a in artefacts}
    for table, column in (("fidelity", "verdict"), ("scorecard", "best_verdict")):
        assert verdicts(told, table, column, engine="mujoco") == {
            "unsupported: cannot represent rim"
        }


def test_what_is_left_out_is_unsupported_in_every_quantity(slipping: Found) -> None:
    told = verdicts(slipping, "fidelity", "verdict", engine="toy")
    assert told == {"unsupported: cannot represent slip"}


@pytest.mark.slow
def test_a_chaotic_run_is_followed_and_not_judged(found: Found, chaos: list[Evaluation]) -> None:
    for e in chaos:
        assert e.errors is None
        assert e.parts_at is not None
        own = {"scene": "chaotic-can", "engine": e.simulation.case.engine}
        expected = {f"not decidable: chaotic, parts after {e.parts_at:.3g} s"}
        assert verdicts(found, "fidelity", "verdict", **own) == expected
        assert verdicts(found, "scorecard", "best_verdict", **own) == expected
        assert verdicts(found, "results", "parts_at_s", **own) == {e.parts_at}


@pytest.mark.slow
def test_every_scene_says_what_its_exact_motion_supposes(
    found: Found, chaos: list[Evaluation]
) -> None:
    for scene in ("chaotic-can", "slipping-rock"):
        text = found[f"{scene}-assumptions"]
        assert isinstance(text, Prose)
        assert text.scene == scene
        assert "keeps to everything that its model assumes" in text.text
        assert all(choice in text.text for choice in modelling_choices(load(scene).effects))
        assert ("is chaotic" in text.text) == (scene == "chaotic-can")
    divergence, text = chaos[0].divergence, found["chaotic-can-assumptions"]
    assert divergence is not None
    assert isinstance(text, Prose)
    assert f"grows by e in {divergence.lyapunov_time:.2g} s" in text.text


def test_a_broken_assumption_is_told_with_the_model_that_would_carry_it() -> None:
    e = evaluated("wobble", "mujoco", 1e-3)
    text = next(a for a in comparison_report([e]) if a.name == "wobble-assumptions")
    assert isinstance(text, Prose)
    assert e.findings
    assert e.findings[0].sentence in text.text
    assert f"A model that would carry it: {e.findings[0].model}." in text.text


def test_slip_is_no_fault_where_the_scene_lets_the_can_slip(slipping: Found) -> None:
    told = verdicts(slipping, "fidelity", "verdict", scene="slipping-rock", quantity="slip_m_s")
    assert told == {
        "not decidable: the scene lets the can slip",
        "unsupported: cannot represent slip",
    }
    energy = verdicts(
        slipping, "fidelity", "verdict", scene="slipping-rock", quantity="energy_drift"
    )
    assert "not decidable: the scene does not conserve its energy" in energy


@pytest.mark.parametrize(
    ("name", "seconds", "quantity", "doubt"),
    [
        # before it lands, and after
        ("dropped-can", 0.05, "lift_off_fraction", "the exact can leaves the plane"),
        ("dropped-can", 0.3, "lift_off_fraction", "the exact can leaves the plane"),
        ("falls-flat", 0.4, "penetration_m", "the exact can lands on its face"),
    ],
)
def test_an_engine_is_not_blamed_for_what_the_exact_can_does(
    name: str, seconds: float, quantity: str, doubt: str
) -> None:
    scene = replace(load(name), horizon=Horizon(seconds=seconds))
    told = {a.name: a for a in comparison_report([evaluated(scene, "mujoco", 1e-3)])}
    assert verdicts(told, "fidelity", "verdict", quantity=quantity) == {f"not decidable: {doubt}"}


def test_the_off_centre_can_has_no_more_to_spend_than_its_fall_gives() -> None:
    e = evaluated("off-centre-mass", "mujoco", 1e-3)
    table = next(a for a in comparison_report([e]) if a.name == "fidelity")
    assert isinstance(table, Table)
    row = table.frame.set_index("quantity").loc["energy_drift"]
    # phi 0.2: the centre is sin(0.2) - h (1 - cos(0.2)) = 0.17 radii higher than of the flat can,
    # and psi' and theta' add what is less than that of m g R
    assert 0.0017 < row["allowed"] < 0.0017 + 0.01
    assert load("off-centre-mass").effects.point_mass is not None
