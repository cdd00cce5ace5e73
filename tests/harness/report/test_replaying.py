"""What a replay is packed into is where the cans were, to less than a pixel."""

import base64
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.core.report_model import Body, Replay
from harness.core.trajectory import Floats
from harness.report.page import frames


@pytest.fixture
def rolled() -> Replay:
    """Return a can that rolls ten turns, far from where it began."""
    time = np.linspace(0.0, 1.0, 480)
    contact = 0.037 * np.column_stack((60.0 * time, np.sin(9.0 * time)))
    body = Body(
        label="exact",
        kind="reference",
        phi=0.3 + 0.1 * np.cos(9.0 * time),
        psi=np.arctan(30.0 * (time - 0.5)),
        theta=-60.0 * time,
        contact=contact,
        height=np.zeros(480),
    )
    return Replay(name="r", title="r", seen="", radius=0.037, height=0.1, time=time, bodies=(body,))


def unpacked(told: dict[str, Any]) -> Floats:
    values = np.frombuffer(base64.b64decode(told["bdata"]), dtype=f"<{told['dtype']}")
    found: Floats = values.astype(np.float64) * told.get("step", 1.0) + told.get("low", 0.0)
    return found


def test_angles_and_places_come_back_within_a_pixel(rolled: Replay) -> None:
    told, body = frames(rolled), rolled.bodies[0]
    packed = told["bodies"][0]
    places = (body.contact - (body.contact.min(axis=0) + body.contact.max(axis=0)) / 2.0) / 0.037
    for name, true in (
        ("psi", body.psi),
        ("theta", body.theta),
        ("x", places[:, 0]),
        ("y", places[:, 1]),
    ):
        # half a step of 1/65535 of the range, and the rounding of a product
        assert np.abs(unpacked(packed[name]) - true).max() <= 0.5001 * np.ptp(true) / 65535
    assert np.array_equal(unpacked(told["time"]), rolled.time)
    assert np.argmin(unpacked(packed["phi"])) == np.argmin(body.phi)


def test_only_a_can_that_flies_has_a_height(rolled: Replay) -> None:
    body = rolled.bodies[0]
    flies = replace(body, height=np.where(rolled.time < 0.5, 0.037 * rolled.time, 0.0))
    first, second = frames(replace(rolled, bodies=(body, flies)))["bodies"]
    assert "z" not in first
    np.testing.assert_allclose(unpacked(second["z"]), flies.height / 0.037, atol=1e-5)


def test_what_stands_still_and_what_is_unknown_come_back(rolled: Replay) -> None:
    body = rolled.bodies[0]
    gone = np.where(np.arange(480) < 400, body.psi, np.nan)
    still = replace(body, theta=np.full(480, 2.0), psi=gone)
    packed = frames(replace(rolled, bodies=(still,)))["bodies"][0]
    assert (unpacked(packed["theta"]) == 2.0).all()
    assert np.array_equal(np.isnan(unpacked(packed["psi"])), np.isnan(gone))
