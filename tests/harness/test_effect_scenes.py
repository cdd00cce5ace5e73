"""The catalogue's scenes with a plane that tilts or shakes, or weight off the axis, in engines."""

from dataclasses import replace

import pytest

from harness.engines.reference.assumption_checks import findings
from harness.metrics.convergence import observed_order
from models import Horizon, load
from tests.support.evaluations import evaluated

ENGINES = ("mujoco", "pybullet")
STEPS = (5e-5, 2.5e-5, 1.25e-5)


@pytest.mark.parametrize("scene", ["tilted-plane", "shaken-plane", "off-centre-mass"])
@pytest.mark.parametrize("name", ENGINES)
def test_errors_under_effects_are_of_first_order(name: str, scene: str) -> None:
    # up to about the first minimum of phi; at 1e-4 s the order of phi is not yet seen in MuJoCo
    piece = replace(load(scene), horizon=Horizon(seconds=0.3))
    errors = [evaluated(piece, name, step).errors for step in STEPS]
    for quantity in ("phi_rms", "rotation_rms", "contact_locus_rms"):
        found = observed_order(STEPS, [getattr(e, quantity) for e in errors])
        assert found.points == len(STEPS)
        assert 0.8 < found.order < 1.3, quantity  # both step by semi-implicit Euler
    assert findings(piece) == ()


@pytest.mark.slow
@pytest.mark.parametrize("name", ENGINES)
def test_of_a_chaotic_scene_no_error_is_given_but_when_it_parts(name: str) -> None:
    scene = load("chaotic-can")
    e = evaluated(scene, name, 1e-4)
    assert e.errors is None
    assert e.truth is not None
    assert e.divergence is not None
    assert e.divergence.chaotic
    assert scene.horizon.seconds is not None
    assert 0.0 < e.divergence.lyapunov_time < scene.horizon.seconds
    # an engine's own errors are some 1e-4, far above the 1e-12 that is grown, so it parts earlier
    assert e.parts_at is not None
    assert 0.0 < e.parts_at < min(e.divergence.parted, scene.horizon.seconds)
    assert abs(e.divergence.decidable_until(1e-4) - e.parts_at) < scene.horizon.seconds / 2.0
