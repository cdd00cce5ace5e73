"""Words: what is not known is said to be so, and no number that is none is spoken."""

from dataclasses import replace

import pytest

from harness.core.report_model import Figure
from harness.studies.attribution.study import ATTRIBUTED, Attribution, AttributionStudy
from harness.studies.shared.ablation import Account, ablation_path, account
from harness.studies.study import run_study
from models import Horizon, Scene, load
from tests.support.figures import assert_two_sentences


@pytest.fixture(scope="module")
def straight() -> Attribution:
    """Return the attribution of a scene that ends with a time, brief enough for a test."""
    scene = replace(load("straight-rolling"), horizon=Horizon(seconds=0.05))
    study = AttributionStudy(path=ablation_path(scene, "mujoco"))
    return study.findings(run_study(study))


def toy(scene: Scene, unknown: set[str]) -> tuple[str, str]:
    """Return the words on discrepancies of 10 less a gap each, the turn unknown in some sets."""
    way = ablation_path(scene, "mujoco")

    def turn(closed: frozenset[str]) -> float | None:
        return None if ("+".join(sorted(closed)) or "none") in unknown else 10.0 - len(closed)

    accounts: dict[str, Account] = {
        q.key: account(way, q, turn if q is ATTRIBUTED[0] else lambda closed: -float(len(closed)))
        for q in ATTRIBUTED
    }
    return Attribution(path=way, evaluations={}, accounts=accounts).sentences


def test_effects_that_add_are_said_to(gentle: Scene) -> None:
    first, second = toy(gentle, set())
    assert "off by +10 degrees in the angle of turn of gentle-rock" in first
    assert "by +6 degrees" in first
    assert "compliance +1; " in first
    assert "hardly interact" in second


def test_an_unknown_effect_is_said_to_be_unknown(gentle: Scene) -> None:
    first, second = toy(gentle, {"compliance"})
    assert "compliance an unknown part" in first
    assert "not known" in second
    assert second.endswith("for compliance.")


def test_with_an_end_unknown_another_quantity_is_told(gentle: Scene) -> None:
    first, _ = toy(gentle, {"none"})
    assert "contact locus" in first
    assert "nan" not in first.lower()


def test_a_scene_without_a_bounce_has_no_turn_to_miss(straight: Attribution) -> None:
    assert "turn" not in " ".join(straight.sentences)
    (figure,) = (a for a in straight.artefacts() if isinstance(a, Figure))
    assert_two_sentences([figure])
    assert "Angle of turn" not in [panel.title for panel in figure.panels]
    assert "turn" not in figure.seen
