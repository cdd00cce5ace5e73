"""The reference on hard and random scenes, and the scaling of mass, length and gravity."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from harness.core.case import Case
from harness.engines.reference.to_reference_problem import refusal
from harness.engines.reference.truth import solve_case, truth
from harness.studies.stability.suite import random_scenes
from harness.studies.stability.survey import ALLOWED, compared, examine
from models import Can, Effects, Scene, Slip, hard_names, load
from tests.support.examples import examples


@pytest.mark.slow
@pytest.mark.parametrize("name", hard_names())
def test_each_hard_case_is_solved_or_refused_with_a_sentence(name: str) -> None:
    found = examine(load(name))
    assert not found.failure
    if found.refusal:
        assert found.refusal.endswith(".")
    else:
        assert found.disagreement <= ALLOWED
        assert found.energy_error <= ALLOWED


def test_random_scenes_do_not_fail_and_are_the_same_every_time() -> None:
    scenes = list(random_scenes(examples(2 / 5)))
    assert scenes == list(random_scenes(examples(2 / 5)))
    assert [found.failure for found in map(examine, scenes) if found.failure] == []


@pytest.mark.parametrize(
    ("number", "outcome"),
    [
        pytest.param(1833, "overturned", id="phi falls to 1e-26 and rises"),
        pytest.param(3911, "overturned", id="barely over the top"),
        pytest.param(5464, "fell flat", marks=pytest.mark.slow, id="a fall of a third of the lean"),
        pytest.param(4786, "finished", id="ten thousand lengths of phi without a force"),
    ],
)
def test_random_scenes_that_once_failed(number: int, outcome: str) -> None:
    found = examine(list(random_scenes(number + 1))[number])
    assert (found.outcome, found.failure, found.refusal) == (outcome, "", "")
    assert found.disagreement <= ALLOWED


def test_a_passage_that_an_ulp_at_the_least_phi_decides_is_refused() -> None:
    """It falls almost flat, rises to the barrier and barely goes over; its release is all right."""
    found = examine(list(random_scenes(97))[96])
    assert not found.failure
    assert "where phi is least" in found.refusal
    assert ALLOWED < found.conditioning < 1e-5


def test_what_cancellation_takes_is_refused_and_not_called_a_failure() -> None:
    """Beside steady rolling the force is what is left of terms that cancel to eight digits."""
    scene = load("gentle-rock")
    unit = math.sqrt(scene.can.radius / scene.gravity)
    h, a, c = scene.can.h, scene.can.a, scene.can.c
    # steady rolling at phi = 0.3 and psi' = 0.5: theta' from eq01:Phi with phi'' = 0
    S, C = math.sin(0.3), math.cos(0.3)
    drive = ((a + h * h - c - 1) * S * C - h * math.cos(0.6)) * 0.25 + h * S - C
    theta_dot = drive / ((c + 1) * S + h * C) / 0.5
    release = replace(
        scene.release, phi=0.3 * (1 - 1e-8), psi_dot=0.5 / unit, theta_dot=theta_dot / unit
    )
    found = examine(replace(scene, release=release))
    assert not found.failure
    assert found.conditioning > ALLOWED
    assert re.fullmatch(
        r"An integration loses \de-0[678] of the force on phi, whose terms cancel\.", found.refusal
    )


def test_a_disagreement_that_no_ulp_explains_is_a_failure() -> None:
    """An integrator that is off by 1e-7 is found out: the bound is tight."""
    scene = load("gentle-rock")
    formula = solve_case(Case(scene=scene, engine="reference", options=(("model", "exact"),)))
    off = replace(scene, release=replace(scene.release, phi=scene.release.phi * (1 + 1e-7)))
    found = compared(scene, formula, solve_case(Case(scene=off, engine="reference")))
    assert "differ" in found.failure
    assert found.conditioning < ALLOWED


def test_a_release_inside_the_plane_is_refused_and_one_above_it_is_not() -> None:
    scene = load("gentle-rock")
    assert refusal(scene) == ""
    assert refusal(replace(scene, release=replace(scene.release, height=0.01))) == ""
    assert "inside" in refusal(replace(scene, release=replace(scene.release, height=-0.001)))


@settings(max_examples=examples(1 / 5))
@given(mass=st.floats(-6.0, 6.0), radius=st.floats(-3.0, 1.0), gravity=st.floats(-5.0, 3.0))
def test_mass_length_and_gravity_leave_the_dimensionless_motion_alone(
    mass: float, radius: float, gravity: float
) -> None:
    scene = load("gentle-rock")
    unit = math.sqrt(scene.can.radius / scene.gravity)
    can = Can.from_groups(mass=10**mass, radius=10**radius, a=0.727, c=0.615, h=1.473)
    other_unit = math.sqrt(can.radius / 10**gravity)
    release = replace(
        scene.release,
        psi_dot=scene.release.psi_dot * unit / other_unit,
        theta_dot=scene.release.theta_dot * unit / other_unit,
    )
    other = replace(scene, can=can, gravity=10**gravity, release=release)

    def bounce(scene: Scene, unit: float) -> tuple[float, ...]:
        (found,) = solve_case(Case(scene=scene, engine="reference")).bounces
        return (
            found.time / unit,
            found.phi_min,
            found.angle_of_turn,
            found.rotation_turn,
            found.peak_psi_dot * unit,
            found.peak_friction_ratio,
        )

    # the groups and the rates are rounded anew: some ulps, felt a few times over
    assert bounce(other, other_unit) == pytest.approx(bounce(scene, unit), rel=1e-12, abs=0)


FLOOR = 1e-6
"""Of a time or an angle, against which its error is held where it vanishes itself."""
SCENES = tuple(random_scenes(60))
ULPS = 4.0 * float(np.finfo(float).eps)
"""How a neighbour differs: the groups and the rates of a scaled scene are rounded twice."""
NEIGHBOURS = 64.0
"""Roundings of the groups fall where those of two neighbours do not, and an integrator's steps."""
LOST = 1e-3
"""Where neighbours are as far apart as this, one ulp decides, and no scaling can be held to it."""


@settings(max_examples=examples(2 / 5))
@given(
    scene=st.sampled_from(SCENES),
    mass=st.floats(-6.0, 6.0),
    radius=st.floats(-3.0, 1.0),
    gravity=st.floats(-5.0, 3.0),
)
def test_scaling_leaves_random_cans_in_every_regime_alone(
    scene: Scene, mass: float, radius: float, gravity: float
) -> None:
    """Of what can be known of each: a neighbour some ulps away says how far that is."""
    groups = {"a": scene.can.a, "c": scene.can.c, "h": scene.can.h}
    unit = math.sqrt(scene.can.radius / scene.gravity)

    def moved(*, mass: float, radius: float, gravity: float, ulps: float = 0.0) -> Scene:
        other, release = math.sqrt(radius / gravity), scene.release
        rates = ("phi_dot", "psi_dot", "theta_dot")
        # apart from each other, too: where they cancel, that is what round-off changes
        signs = zip(rates, (1.0, -1.0, 1.0), strict=True)
        return replace(
            scene,
            can=Can.from_groups(mass=mass, radius=radius, **groups),
            gravity=gravity,
            release=replace(
                release,
                phi=release.phi * (1.0 + ulps),
                **{
                    name: getattr(release, name) * (unit / other) * (1.0 + sign * ulps)
                    for name, sign in signs
                },
            ),
        )

    def dimensionless(scene: Scene) -> tuple[str, np.ndarray]:
        unit, motion = (
            math.sqrt(scene.can.radius / scene.gravity),
            solve_case(Case(scene=scene, engine="reference")),
        )
        figures = [motion.ends / unit]
        for found in motion.bounces:
            figures += [found.time / unit, found.phi_min, found.angle_of_turn]
            figures += [found.rotation_turn, found.peak_psi_dot * unit]
        return motion.solution.outcome.name, np.array(figures)

    def apart(one: np.ndarray, other: np.ndarray) -> float:
        return float((np.abs(one - other) / np.maximum(np.abs(one), FLOOR)).max())

    own = {"mass": scene.can.mass, "radius": scene.can.radius, "gravity": scene.gravity}
    outcome, plain = dimensionless(moved(**own))
    near = [dimensionless(moved(**own, ulps=ulps)) for ulps in (-ULPS, ULPS)]
    assume(all(name == outcome and other.size == plain.size for name, other in near))
    spread = max(apart(plain, other) for _, other in near)
    assume(spread < LOST)
    scaled, found = dimensionless(
        moved(mass=10.0**mass, radius=10.0**radius, gravity=10.0**gravity)
    )
    assert scaled == outcome
    assert apart(plain, found) <= max(1e-12, NEIGHBOURS * spread)


@pytest.mark.parametrize("share", [0.999, 1.001])
def test_a_thousandth_of_friction_decides_by_which_models_it_is_examined(share: float) -> None:
    gentle = load("gentle-rock")
    mu = truth(gentle).bounces[0].peak_friction_ratio * share
    found = examine(replace(gentle, effects=Effects(slip=Slip(mu=mu))))
    assert (found.failure, found.refusal) == ("", "")
    assert found.disagreement <= ALLOWED
    # a rim that slips is followed from event to event, one that rolls takes a step or two
    assert (found.evaluations > 1000) is (share < 1.0)
