"""What is said of an exact motion: which may be chaotic, and what carries what it breaks."""

from dataclasses import replace

import pytest

import reference.integrable.exact_motion
from harness.cli.motions import BrokenRunError, model_answer, sentences
from harness.core.case import Case
from harness.core.simulation import Outcome
from harness.engines.reference.assumption_checks import divergence_of, findings, may_be_chaotic
from harness.engines.reference.truth import solve_case, truth
from harness.evaluation.evaluate import evaluate_without_truth
from models import Damping, Effects, Horizon, PointMass, RollingResistance, Scene, Tilt, load
from reference import FindingKind
from reference.integrable.effective_potential import EffectivePotential
from reference.integrable.turning_points import TurningPoints, turning_points

GENTLE = load("gentle-rock")


def with_effects(**effects: object) -> Scene:
    return replace(GENTLE, effects=Effects(**effects))  # type: ignore[arg-type]


def said(scene: Scene, model: str = "auto") -> list[str]:
    """Return what a person reads of the model beside the numbers."""
    case = Case(scene=scene, engine="reference", options=(("model", model),))
    e = evaluate_without_truth(case)
    known = e.simulation.trajectory is not None or e.simulation.outcome is Outcome.FINISHED
    return list(sentences(model_answer(e, solve_case(case) if known else None, model)))


@pytest.mark.parametrize(
    ("scene", "chaotic"),
    [
        (GENTLE, False),
        (with_effects(point_mass=PointMass(mass=1e-3, z=0.02)), False),
        (with_effects(point_mass=PointMass(mass=1e-3, y=0.01, z=0.02)), True),
        (with_effects(point_mass=PointMass(mass=1e-3, z=0.02), tilt=Tilt(angle=0.1)), True),
    ],
    ids=["ideal", "mass on the axis", "mass off the axis", "tilted"],
)
def test_what_is_axisymmetric_on_a_level_plane_is_not_chaotic(
    scene: Scene, *, chaotic: bool
) -> None:
    assert may_be_chaotic(scene) is chaotic
    assert (divergence_of(scene) is not None) is chaotic


def test_a_can_that_rolling_resistance_holds_is_a_motion_like_any_other() -> None:
    phi = GENTLE.can.balancing_angle
    release = replace(GENTLE.release, phi=phi, psi_dot=0.0, theta_dot=0.0)
    scene = replace(
        with_effects(rolling_resistance=RollingResistance(length=3e-5)),
        release=release,
        horizon=Horizon(seconds=0.5),
    )
    e = evaluate_without_truth(Case(scene=scene, engine="reference"))
    assert e.simulation.outcome is Outcome.FINISHED
    assert e.simulation.trajectory is not None
    assert findings(scene) == ()


@pytest.mark.parametrize(
    ("scene", "kind", "model"),
    [
        (load("wobble"), FindingKind.FRICTION, "coulomb"),
        pytest.param(
            replace(load("wobble"), effects=Effects(damping=Damping(linear=1e-6, angular=1e-6))),
            FindingKind.FRICTION,
            "",
            marks=pytest.mark.slow,
        ),
        (load("planar-fall"), FindingKind.ENDING, ""),
    ],
    ids=["rolling", "general", "flat"],
)
def test_a_finding_says_what_carries_it(scene: Scene, kind: FindingKind, model: str) -> None:
    (found,) = findings(scene)
    assert (found.kind, found.model) == (kind, model)
    (read,) = (sentence for sentence in said(scene) if sentence.startswith("Finding"))
    assert ("would carry it" in read) is bool(model)


def test_a_formula_that_falls_back_says_so() -> None:
    (read,) = (s for s in said(load("planar-fall"), "exact") if s.startswith("Model"))
    assert "Asked for exact" in read
    assert "where nothing bounces it falls back to rolling" in read
    assert "The smallest is pendulum." in read
    (read,) = (s for s in said(GENTLE, "exact") if s.startswith("Model: exact"))
    assert "falls back" not in read


def test_a_model_without_a_locus_is_named_though_the_motion_ends_early() -> None:
    (read,) = said(load("planar-fall"), "reduced")
    assert read.startswith("Model: reduced, 2 equations. Asked for;")


def test_what_is_no_motion_is_no_answer() -> None:
    e = evaluate_without_truth(Case(scene=GENTLE, engine="reference"))
    broken = replace(e.simulation, outcome=Outcome.BROKEN, trajectory=None, note="no number")
    with pytest.raises(BrokenRunError) as caught:
        model_answer(replace(e, simulation=broken), None, "auto")
    assert (caught.value.case, caught.value.note) == (broken.case.label(), "no number")


def test_that_two_methods_agree_is_said_and_that_they_do_not_is_a_finding(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    confirmed = [line for line in said(GENTLE) if line.startswith("Confirmed")]
    assert len(confirmed) == 1
    assert "round-off allows" in confirmed[0]
    assert any("ends in the same way" in line for line in said(load("steady-rolling")))
    assert not any("Confirmed" in line for line in said(GENTLE, "rolling"))

    def wrong(well: EffectivePotential, **options: bool) -> TurningPoints:
        # the motion of another can, which is no less smooth
        return turning_points(replace(well, short=well.short * (1 + 1e-9)), **options)

    monkeypatch.setattr(reference.integrable.exact_motion, "turning_points", wrong)
    scene = replace(GENTLE, name="wrongly-solved")
    lines = said(scene)
    assert not any("Confirmed" in line for line in lines)
    assert sum("one of them is wrong" in line for line in lines) == 1
    # engines are held to the same motion, and it is said of them as well
    (finding,) = findings(scene)
    assert finding.kind is FindingKind.DISAGREEMENT
    case = Case(scene=scene, engine="reference")
    motion = truth(scene)
    assert motion.bounces == solve_case(case).bounces
    seen = model_answer(evaluate_without_truth(case), motion, "auto")["agreement"]
    assert seen["holds"] is False
    assert seen["resolved"] is True
    assert seen["discrepancy"] > 1e-10
