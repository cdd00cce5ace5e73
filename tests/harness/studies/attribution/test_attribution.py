"""Attribution of the real engines on the gentle release: it sums, and each row runs again."""

import json
import math
import shlex

import pandas as pd
import pytest

from harness.cli.main import code_of
from harness.core.report_model import Figure, Prose, Table
from harness.core.simulation import Outcome
from harness.studies.attribution.study import Attribution, AttributionStudy
from harness.studies.shared.ablation import ablation_path, total
from harness.studies.study import run_study
from models import Scene, load
from tests.support.evaluations import evaluated
from tests.support.figures import assert_two_sentences

_SCALES = {"turn_error_deg": 360.0, "contact_locus_rms_m": 0.1, "phi_rms_rad": 1.0}


@pytest.fixture(scope="module", params=["mujoco", pytest.param("pybullet", marks=pytest.mark.slow)])
def found(request: pytest.FixtureRequest, gentle: Scene) -> Attribution:
    study = AttributionStudy(path=ablation_path(gentle, request.param))
    return study.findings(run_study(study))


def runs(found: Attribution) -> pd.DataFrame:
    (table,) = (a for a in found.artefacts() if isinstance(a, Table) and a.name.endswith("-runs"))
    assert set(table.frame.columns) == set(table.columns)
    return table.frame


def test_no_run_is_stopped_at_the_gate(found: Attribution) -> None:
    assert {e.simulation.outcome for e in found.evaluations.values()} == {Outcome.FINISHED}


def test_the_parts_sum_to_the_whole(found: Attribution) -> None:
    shipped = evaluated("gentle-rock", found.path.engine, profile="default").errors
    matched = evaluated("gentle-rock", found.path.engine).errors
    assert shipped is not None
    assert matched is not None
    wholes = {
        "turn_error_deg": math.degrees(shipped.angle_of_turn[0])
        - math.degrees(matched.angle_of_turn[0]),
        "contact_locus_rms_m": shipped.contact_locus_rms - matched.contact_locus_rms,
        "phi_rms_rad": shipped.phi_rms - matched.phi_rms,
    }
    for key, whole in wholes.items():
        account = found.accounts[key]
        # each of at most seven differences, and their sum, is rounded at the size of the levels
        few_ulps = 16 * math.ulp(_SCALES[key])
        assert total(account.in_order) == pytest.approx(whole, rel=0, abs=few_ulps)
        alone, interaction = total(account.alone), account.interaction
        assert alone is not None
        assert interaction is not None
        assert alone - interaction == pytest.approx(whole, rel=0, abs=few_ulps)


def test_the_first_gap_does_alone_what_it_does_in_order(found: Attribution) -> None:
    for account in found.accounts.values():
        assert account.in_order[0] == account.alone[0]
        assert account.in_order[-1] == account.left_open[-1]


def test_every_row_has_a_command_that_reproduces_it(
    found: Attribution, capsys: pytest.CaptureFixture[str]
) -> None:
    frame = runs(found)
    chosen = frame[frame["step"].isin(["as shipped", "left open"])].iloc[[0, 1, -2]]
    for row in chosen.itertuples():
        words = shlex.split(str(row.command))
        assert words[0] == "rockingcan"
        capsys.readouterr()
        assert code_of([*words[1:], "--json"]) == 0
        answer = json.loads(capsys.readouterr().out)
        assert answer["errors"]["angle_of_turn_deg"][0] == row.turn_error_deg
        assert answer["errors"]["contact_locus_rms_m"] == row.contact_locus_rms_m


def test_words_are_two_sentences_without_a_number_that_is_none(found: Attribution) -> None:
    (prose,) = (a for a in found.artefacts() if isinstance(a, Prose))
    assert len(found.sentences) == 2
    assert all(sentence.endswith(".") for sentence in found.sentences)
    assert "nan" not in prose.text.lower().replace("nanometre", "")
    assert all(name in prose.text for name in found.path.names)


def test_the_waterfall_goes_down_from_shipped_to_matched(found: Attribution) -> None:
    (figure,) = (a for a in found.artefacts() if isinstance(a, Figure))
    assert_two_sentences([figure])
    turn = figure.panels[0]
    ends, falls, alone = turn.series
    account = found.accounts["turn_error_deg"]
    assert ends.y.tolist() == [account.as_shipped, account.remains]
    assert falls.base is not None
    assert falls.base[0] == account.as_shipped
    assert falls.y[-1] == account.remains
    assert falls.base[1:].tolist() == falls.y[:-1].tolist()
    # levels of some degrees, subtracted twice
    assert alone.y[0] == pytest.approx(falls.y[0], rel=0, abs=4 * math.ulp(10.0))
    assert turn.x_names == ("as shipped", *found.path.names, "matched")


def test_who_is_to_blame(found: Attribution) -> None:
    turn = found.accounts["turn_error_deg"]
    parts = {name: abs(part) for name, part in turn.by_gap(turn.in_order).items()}
    blamed = {"mujoco": "compliance", "pybullet": "inertia"}[found.path.engine]
    assert max(parts, key=lambda name: parts[name]) == blamed
    assert parts["solver"] < 0.01  # deg: a single contact is solved nearly at once


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
def test_a_turn_that_cannot_be_counted_is_not_attributed(engine: str) -> None:
    study = AttributionStudy(
        path=ablation_path(load("paper-release"), engine, 1e-6, first=("timestep",))
    )
    found = study.findings(run_study(study))
    turn, locus = found.accounts["turn_error_deg"], found.accounts["contact_locus_rms_m"]
    assert turn.whole is None  # a step as shipped is longer than the bounce
    assert turn.in_order[0] is None
    assert all(part is not None for part in turn.in_order[1:])
    assert locus.whole is not None
    assert "cannot be counted" in found.sentences[0]
