"""MuJoCo's earlier versions: what the adapter does for what they do not have."""

from collections.abc import Iterator

import numpy as np
import pytest

from harness.core.case import Case
from harness.engines.registry import engine
from models import load

pytestmark = pytest.mark.engine("mujoco")


@pytest.fixture
def _without_contact_sensors(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    import mujoco  # noqa: PLC0415 - as below

    from harness.engines.mujoco import compiled_scene  # noqa: PLC0415 - only where MuJoCo is

    monkeypatch.setattr(compiled_scene, "HAS_CONTACT_SENSORS", False)
    yield
    mujoco.set_mjcb_sensor(None)


@pytest.mark.usefixtures("_without_contact_sensors")
@pytest.mark.parametrize("scene", ["gentle-rock", "slipping-rock"])
@pytest.mark.parametrize("profile", ["default", "matched"])
def test_filled_sensors_hold_what_mujoco_s_own_do(
    monkeypatch: pytest.MonkeyPatch, scene: str, profile: str
) -> None:
    from harness.engines.mujoco import compiled_scene  # noqa: PLC0415 - only where MuJoCo is

    case = Case(scene=load(scene), engine="mujoco", profile=profile)
    filled = engine("mujoco").simulate(case)
    monkeypatch.setattr(compiled_scene, "HAS_CONTACT_SENSORS", True)
    own = engine("mujoco").simulate(case)
    assert (filled.outcome, filled.steps) == (own.outcome, own.steps)
    assert filled.trajectory is not None
    assert own.trajectory is not None
    for name in ("time", "position", "quaternion", "penetration", "contact_count"):
        assert np.array_equal(
            getattr(filled.trajectory, name), getattr(own.trajectory, name), equal_nan=True
        )
    # a mean of up to four points and a sum of as many forces, in another order
    eps = 8.0 * np.finfo(float).eps
    for name in ("contact_point", "contact_force"):
        one, other = getattr(filled.trajectory, name), getattr(own.trajectory, name)
        np.testing.assert_allclose(one, other, rtol=0.0, atol=eps * np.nanmax(np.abs(other)))


def test_a_flag_that_no_version_has_is_none() -> None:
    from harness.engines.mujoco.colliders import is_flag  # noqa: PLC0415 - only where MuJoCo is

    assert is_flag("warmstart")
    assert is_flag("energy")  # one that has to be enabled
    assert not is_flag("nonsense")
