"""Exudyn: its order, the forces of its joint, what it ships with, and settings to paste."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.core.errors import UnsupportedEffectError
from harness.core.simulation import Outcome
from harness.engines.parity.contact import FRICTIONS
from harness.engines.probes import measure
from harness.engines.registry import (
    check_effects,
    engine,
    export_settings,
    names,
    not_installed,
    variants,
)
from harness.engines.stepping.settling import above_origin, moving
from harness.evaluation.evaluate import evaluate
from models import Horizon, PointMass, Release, Scene, load, quaternion
from models.effects import Effects
from tests.support.engines import stepping_engine
from tests.support.evaluations import turn_error

pytestmark = pytest.mark.engine("exudyn")


def case_of(scene: Scene, timestep: float | None = None, **options: Value) -> Case:
    """Return a matched case of Exudyn."""
    return Case(scene=scene, engine="exudyn", timestep=timestep, options=tuple(options.items()))


@pytest.mark.parametrize(
    ("timestep", "error"),
    [(1e-3, 0.0252), (1e-4, 2.52e-4), pytest.param(1e-5, 2.52e-6, marks=pytest.mark.slow)],
)
def test_the_gentle_release_turns_in_the_second_order(
    gentle: Scene, timestep: float, error: float
) -> None:
    # a hundredth for a tenth of the timestep is the order, the factor is the record
    assert turn_error(case_of(gentle, timestep)) == pytest.approx(error, rel=0.01)


@pytest.mark.parametrize("solver", ["TrapezoidalIndex2", "GeneralizedAlpha"])
def test_phi_converges_in_the_second_order_with_both_methods(gentle: Scene, solver: str) -> None:
    coarse, fine = (
        evaluate(case_of(gentle, timestep, solverType=solver)).errors for timestep in (1e-3, 2.5e-4)
    )
    assert coarse is not None
    assert fine is not None
    assert coarse.phi_rms / fine.phi_rms == pytest.approx(16.0, rel=0.1)


def test_the_paper_release_turns_with_adaptive_steps() -> None:
    adaptive = replace(case_of(load("paper-release")), profile="adaptive")
    assert abs(turn_error(adaptive)) < 5e-4


def test_the_force_of_a_step_is_the_one_that_moved_the_can(gentle: Scene) -> None:
    brief = replace(gentle, horizon=Horizon(seconds=0.02))
    path = engine("exudyn").simulate(case_of(brief, 1e-3)).trajectory
    assert path is not None
    assert len(path.time) == 21  # each step has a sample
    gained = gentle.can.mass * np.diff(path.velocity, axis=0) / np.diff(path.time)[:, None]
    weight = np.array((0.0, 0.0, gentle.can.mass * gentle.gravity))
    # Newton's method stops at 1e-12
    assert np.abs(gained + weight - path.contact_force[:-1]).max() < 1e-10 * weight[2]


def test_a_can_rolls_where_it_is_placed_on_its_rim_and_flies_above_it(gentle: Scene) -> None:
    world = stepping_engine("exudyn").open(case_of(gentle, 1e-3))
    can, tilted = gentle.can, quaternion(0.3, 0.0, 0.0)
    height = can.radius * math.sin(0.3) + can.half_height * math.cos(0.3)
    for above, counted in ((0.0, 1), (-1e-3, 1), (1e-3, 0)):
        world.place(above_origin(height + above, tilted), moving())
        assert world.signed_distance() == pytest.approx(above, abs=1e-16)
        world.step()
        assert world.contact().count == counted
    assert world.twist().velocity[2] == pytest.approx(-gentle.gravity * 1e-3, rel=1e-12)


def test_the_plane_may_pull_and_what_the_exact_motion_asks_for_is_followed(gentle: Scene) -> None:
    # the rim is thrown upwards faster than the centre falls
    thrown = replace(
        gentle, release=replace(gentle.release, phi_dot=60.0), horizon=Horizon(seconds=5e-3)
    )
    e = evaluate(case_of(thrown, 1e-4))
    path = e.simulation.trajectory
    assert path is not None
    assert path.contact_force[:, 2].min() < 0.0
    assert (path.contact_count == 1).all()
    assert not e.truth_pulls


def test_a_can_that_lies_exactly_flat_ends_as_an_outcome(gentle: Scene) -> None:
    flat = replace(gentle, release=Release(phi=1e-12), horizon=Horizon(seconds=0.01))
    assert engine("exudyn").simulate(case_of(flat, 1e-3)).outcome is Outcome.DIVERGED


def test_a_release_above_the_plane_is_refused_with_the_engines_that_have_contacts(
    gentle: Scene,
) -> None:
    lifted = replace(gentle, release=replace(gentle.release, height=0.01))
    with pytest.raises(UnsupportedEffectError) as caught:
        check_effects("exudyn", lifted)
    assert caught.value.effect == "release.height"
    assert "exudyn" not in caught.value.able
    assert set(caught.value.able) <= set(names())
    check_effects("exudyn", replace(gentle, release=replace(gentle.release, height=-0.001)))


def test_what_is_asked_of_a_contact_is_said_not_to_apply(gentle: Scene) -> None:
    rows = stepping_engine("exudyn").parity(case_of(gentle, 1e-3))
    apart = {row.quantity: row.how for row in rows if row.verdict == "does not apply"}
    assert apart == dict.fromkeys(FRICTIONS, "does not apply: constraint")
    probed = measure(case_of(gentle, 1e-3)).findings
    refused = {each.effect for each in probed if each.how == "does not apply: constraint"}
    assert refused == {
        *("compliance", "friction compliance", "contact points", "stabilisation"),
        *("declared compliance", "declared restitution"),
    }


def test_a_point_mass_is_carried_and_a_step_that_turns_by_radians_is_said_to_fail(
    gentle: Scene,
) -> None:
    scene = replace(gentle, effects=Effects(point_mass=PointMass(mass=4e-3, x=0.02)))
    for timestep, fails in ((1e-3, {"spin kept"}), (1e-4, set[str]())):
        rows = stepping_engine("exudyn").parity(case_of(scene, timestep))
        imposed = {row.quantity for row in rows if row.verdict == "imposed"}
        # Newton's method leaves some hundred roundings of the spin
        assert imposed - {"angular damping"} == fails
        assert "mismatch" not in {row.verdict for row in rows}


def test_what_it_ships_with_is_what_is_stated() -> None:
    import exudyn  # noqa: PLC0415 - may not be installed

    times = exudyn.SimulationSettings().timeIntegration
    stated = {setting.name: setting.default for setting in engine("exudyn").settings}
    assert times.solverType.name == stated["solverType"]
    assert times.generalizedAlpha.spectralRadius == stated["spectralRadius"]
    for name in ("useModifiedNewton", "relativeTolerance", "absoluteTolerance", "maxIterations"):
        assert getattr(times.newton, name) == stated[name]


@pytest.mark.parametrize(
    "variant",
    () if "exudyn" in not_installed() else variants("exudyn"),
    ids=lambda variant: variant.name,
)
def test_what_is_pasted_runs_and_means_the_case(variant: Any) -> None:
    case = replace(
        case_of(load("gentle-rock"), 2.0**-12), profile=variant.profile, options=variant.settings
    )
    chosen = stepping_engine("exudyn").resolve(case)
    asked: list[tuple[Any, Any]] = []

    class System:
        def SolveDynamic(self, settings: Any, solverType: Any) -> None:
            asked.append((settings, solverType))

    exec(compile(export_settings(case), "pasted", "exec"), {"mbs": System()})  # noqa: S102 - a user would
    ((settings, solver),) = asked
    times = settings.timeIntegration
    assert times.endTime / times.numberOfSteps == 2.0**-12
    assert solver.name == chosen["solverType"]
    assert times.generalizedAlpha.spectralRadius == chosen["spectralRadius"]
    for name in ("useModifiedNewton", "relativeTolerance", "absoluteTolerance", "maxIterations"):
        assert getattr(times.newton, name) == chosen[name]


def test_nothing_is_printed_or_written(
    gentle: Scene, capfd: pytest.CaptureFixture[str], tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    violent = replace(gentle.release, phi=1.0, theta_dot=1e12, psi_dot=1e12)
    found = engine("exudyn").simulate(case_of(replace(gentle, release=violent), 1e-3))
    assert found.outcome in {Outcome.DIVERGED, Outcome.OVERTURNED}
    said = capfd.readouterr()
    assert (said.out, said.err) == ("", "")
    assert list(tmp_path.iterdir()) == []


def test_iterations_of_newtons_method_are_counted(gentle: Scene) -> None:
    chosen: Any = stepping_engine("exudyn")
    counts = []
    for tolerance in (1e-2, 1e-12):
        world = chosen.open(case_of(gentle, 1e-3, relativeTolerance=tolerance))
        world.place(above_origin(0.0645, quaternion(0.4, 0.0, 0.0)), moving())
        counts.append(chosen.counted_step(world))
    assert 0 < counts[0] < counts[1]
