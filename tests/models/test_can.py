"""The can: its groups, and what no rigid body can be."""

import math
import pickle
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models import Can, InvalidValueError, ModelError

PAPER = {"mass": 0.043, "radius": 0.037, "a": 0.727, "c": 0.615, "h": 1.473}
EPS = 2.0**-52
sizes = st.floats(1e-6, 1e6)


@given(mass=sizes, radius=sizes, a=sizes, ratio=st.floats(1e-6, 2.0), h=sizes)
def test_the_groups_come_back(mass: float, radius: float, a: float, ratio: float, h: float) -> None:
    can = Can.from_groups(mass=mass, radius=radius, a=a, c=a * ratio, h=h)
    # one product in, one product and one quotient out
    assert can.a == pytest.approx(a, rel=4 * EPS, abs=0)
    assert can.c == pytest.approx(a * ratio, rel=4 * EPS, abs=0)
    assert can.h == pytest.approx(h, rel=4 * EPS, abs=0)


def test_the_papers_can_balances_at_34_degrees() -> None:
    can = Can.from_groups(**PAPER)
    assert can.balancing_angle == pytest.approx(math.atan(1.0 / 1.473), rel=2 * EPS, abs=0)
    assert round(math.degrees(can.balancing_angle)) == 34  # footnote to (eq:phistar)
    assert can.bounding_radius == pytest.approx(0.037 * math.hypot(1.0, 1.473), rel=4 * EPS, abs=0)


def test_the_moments_the_paper_prints_are_those_of_another_can() -> None:
    printed = Can(
        mass=0.043,
        radius=0.037,
        half_height=0.0545,
        transverse_inertia=6.97e-5,
        axial_inertia=5.89e-5,
    )
    assert round(printed.a, 3) == 1.184  # where its results need 0.727
    assert round(printed.c, 4) == 1.0006  # where they need 0.615


@given(mass=sizes, radius=sizes, a=sizes)
def test_a_disk_without_thickness_is_allowed_and_nothing_beyond_it(
    mass: float, radius: float, a: float
) -> None:
    disk = Can.from_groups(mass=mass, radius=radius, a=a, c=2.0 * a, h=0.01)
    assert disk.axial_inertia == 2.0 * disk.transverse_inertia
    with pytest.raises(InvalidValueError):
        Can.from_groups(mass=mass, radius=radius, a=a, c=math.nextafter(2.0 * a, 9e9), h=0.01)


def test_moments_of_no_rigid_body_are_refused() -> None:
    with pytest.raises(InvalidValueError) as caught:
        Can(mass=1.0, radius=1.0, half_height=1.0, transverse_inertia=1.0, axial_inertia=2.5)
    assert (caught.value.key, caught.value.value) == ("axial_inertia", 2.5)


@pytest.mark.parametrize("key", ["mass", "radius", "a", "c", "h"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf, "heavy", None, True])
def test_every_quantity_must_be_finite_and_positive(key: str, value: Any) -> None:
    groups: dict[str, Any] = PAPER | {key: value}
    with pytest.raises(InvalidValueError) as caught:
        Can.from_groups(**groups)
    assert (caught.value.key, repr(caught.value.value)) == (key, repr(value))
    assert isinstance(caught.value, ModelError | ValueError)


def test_moments_that_underflow_are_refused_and_not_rounded_to_zero() -> None:
    with pytest.raises(InvalidValueError) as caught:
        Can.from_groups(**(PAPER | {"mass": 1e-300, "radius": 1e-100}))
    assert (caught.value.key, caught.value.value) == ("transverse_inertia", 0.0)


def test_an_error_keeps_its_message_through_pickling() -> None:
    error = InvalidValueError("mass", -1.0, "positive")
    again = pickle.loads(pickle.dumps(error))  # noqa: S301  # our own bytes
    assert (again.key, again.value, again.allowed) == ("mass", -1.0, "positive")
    assert str(again) == "`mass` is -1.0, but must be positive"
