"""Every field of a problem refuses what makes no sense: the error names it and keeps the value.

The fields are those that the classes have: a new one without invalid values here fails.
"""

import pickle
from dataclasses import fields, replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from reference import (
    PAPER_CAN,
    Compliance,
    EffectError,
    Effects,
    Gravity,
    Mass,
    ParameterError,
    Parameters,
    Problem,
    ProblemError,
    RefusedError,
    Restitution,
)

Invalid = SearchStrategy[Any]

VALID: dict[type, Any] = {
    Mass: Mass(share=0.1, x=0.2),
    Gravity: Gravity(),
    Compliance: Compliance(stiffness=1e3),
    Restitution: Restitution(coefficient=0.5),
    Effects: Effects(mu=0.3),
    Parameters: PAPER_CAN,
    Problem: Problem(parameters=PAPER_CAN, phi=0.3, bounces=1),
}
ERRORS = {
    Mass: EffectError,
    Gravity: EffectError,
    Compliance: EffectError,
    Restitution: EffectError,
    Effects: EffectError,
    Parameters: ParameterError,
    Problem: ProblemError,
}
NOT_FINITE = st.sampled_from([float("nan"), float("inf"), -float("inf"), 10**400])
NO_NUMBER = st.sampled_from(["0.3", True, [0.3], (0.3,), 0.3 + 0j, object()])
NEGATIVE = st.floats(max_value=-5e-324, allow_infinity=False) | st.integers(max_value=-1)
ANY = NOT_FINITE | NO_NUMBER | st.none()
NOT_NEGATIVE = ANY | NEGATIVE
POSITIVE = NOT_NEGATIVE | st.just(0.0)
ABOVE_ONE = st.floats(min_value=1.0, exclude_min=True, allow_infinity=False)


def no_vector(length: int) -> Invalid:
    """Draw what is no tuple of so many numbers: a list, too short, too long, or with a bad part."""
    rest = st.lists(st.floats(-1, 1), min_size=length - 1, max_size=length - 1)
    bad = st.tuples(rest, NOT_FINITE | NO_NUMBER).map(lambda drawn: (*drawn[0], drawn[1]))
    short = st.just((0.0,) * (length - 1))
    return bad | short | st.just((0.0,) * (length + 1)) | st.just([0.0] * length) | ANY


def turned_down(length: float) -> tuple[float, float, float]:
    return (0.0, 0.0, -length)


INVALID: dict[tuple[type, str], Invalid] = {
    (Mass, "share"): POSITIVE,
    (Mass, "x"): ANY,
    (Mass, "y"): ANY,
    (Mass, "z"): ANY,
    (Gravity, "constant"): no_vector(3)
    | st.just((1.0, 0.0, 0.0))
    | st.just((0.0, 0.0, 1.0))
    | st.floats(0, 1 - 1e-14).map(turned_down)
    | st.floats(1 + 1e-14, 1e300).map(turned_down),
    (Gravity, "amplitude"): no_vector(3),
    (Gravity, "rate"): NOT_NEGATIVE,
    (Gravity, "phase"): ANY,
    (Effects, "mu"): NOT_FINITE | NO_NUMBER | NEGATIVE,
    (Effects, "mu_static"): NOT_FINITE | NO_NUMBER | NEGATIVE | st.floats(0.0, 0.299),
    (Effects, "patch"): NOT_NEGATIVE,
    (Effects, "contour"): NOT_NEGATIVE,
    (Effects, "contour_damping"): NOT_NEGATIVE,
    (Effects, "film"): NOT_NEGATIVE,
    (Effects, "boundary_layer"): NOT_NEGATIVE,
    (Effects, "compliance"): NOT_FINITE | NO_NUMBER | st.just(VALID[Gravity]),
    (Effects, "restitution"): NOT_FINITE | NO_NUMBER | st.just(VALID[Gravity]),
    (Compliance, "stiffness"): POSITIVE,
    (Compliance, "damping"): NOT_NEGATIVE,
    (Compliance, "exponent"): ANY | st.floats(max_value=1.0, exclude_max=True) | st.floats(2.1),
    (Restitution, "coefficient"): NOT_NEGATIVE | ABOVE_ONE,
    (Restitution, "law"): st.sampled_from(["", "Newton", 1, None, object()]),
    (Effects, "drilling"): NOT_NEGATIVE,
    (Effects, "rolling_resistance"): NOT_NEGATIVE,
    (Effects, "linear_damping"): NOT_NEGATIVE,
    (Effects, "angular_damping"): NOT_NEGATIVE,
    (Effects, "rim"): NOT_NEGATIVE | ABOVE_ONE,
    (Effects, "gravity"): ANY | st.just((0.0, 0.0, -1.0)) | st.just(VALID[Mass]),
    (Effects, "mass"): NOT_FINITE | NO_NUMBER | st.just(0.1) | st.just(VALID[Gravity]),
    (Parameters, "a"): POSITIVE,
    (Parameters, "c"): POSITIVE | st.floats(2 * 0.727, 1e300, exclude_min=True),
    (Parameters, "h"): POSITIVE,
    (Problem, "parameters"): ANY | st.just((0.727, 0.615, 1.473)),
    (Problem, "phi"): POSITIVE | st.floats(1.5707963267948966, 1e300),
    (Problem, "psi"): ANY,
    (Problem, "theta"): ANY,
    (Problem, "phi_dot"): ANY,
    (Problem, "psi_dot"): ANY,
    (Problem, "theta_dot"): ANY,
    (Problem, "bounces"): NO_NUMBER | NEGATIVE | st.floats() | st.just(0) | st.none(),
    (Problem, "duration"): POSITIVE,
    (Problem, "height"): NOT_NEGATIVE | st.floats(min_value=5e-324),
    (Problem, "effects"): ANY | st.just(VALID[Gravity]),
    (Problem, "slip"): no_vector(2) | st.just((0.1, 0.0)),
}
FIELDS = [(kind, field.name) for kind in VALID for field in fields(kind)]


def test_every_field_has_invalid_values() -> None:
    assert set(INVALID) == set(FIELDS)


@pytest.mark.parametrize(
    ("kind", "name"), FIELDS, ids=[f"{kind.__name__}.{name}" for kind, name in FIELDS]
)
@given(data=st.data())
def test_an_invalid_value_is_refused_by_name(kind: type, name: str, data: st.DataObject) -> None:
    value = data.draw(INVALID[kind, name])
    changed = {name: value}
    if name == "duration":
        changed["bounces"] = None
    with pytest.raises(ERRORS[kind]) as refused:
        replace(VALID[kind], **changed)
    error = refused.value
    if error.key == "horizon":  # neither bounces nor a duration is given
        assert (name, error.value) in {("bounces", (None, None)), ("duration", (None, None))}
    else:
        assert error.key == name
        assert error.value is value
    assert error.allowed
    said = str(error)
    assert error.allowed in said
    assert repr(value)[:40] in said
    assert len(said.splitlines()) == 1


@pytest.mark.parametrize("kind", sorted(set(ERRORS.values()), key=str))
@pytest.mark.parametrize("sentence", ["", "a sentence of its own"])
def test_an_error_keeps_its_fields_and_its_message_through_pickling(
    kind: type[RefusedError], sentence: str
) -> None:
    error = kind("phi", -1.0, "positive", sentence)
    again = pickle.loads(pickle.dumps(error))  # noqa: S301 - our own bytes
    assert (again.key, again.value, again.allowed) == ("phi", -1.0, "positive")
    assert type(again) is kind
    assert str(again) == str(error) == (sentence or "`phi` must be positive, got -1.0")


@pytest.mark.parametrize("kind", VALID)
def test_what_is_valid_is_taken_as_it_is(kind: type) -> None:
    assert replace(VALID[kind]) == VALID[kind]


@given(rim=st.floats(0.0, 1.0), h=st.floats(0.05, 3.0))
def test_a_rim_is_as_round_as_the_can_allows(rim: float, h: float) -> None:
    """Its arc lies beyond neither the axis nor the middle of the can."""
    can = Parameters(a=0.25 + h * h / 3, c=0.5, h=h)
    effects = Effects(rim=rim)
    if rim <= h:
        assert Problem(parameters=can, phi=0.3, bounces=1, effects=effects).effects.rim == rim
    elif rim > h * (1 + 1e-14):
        with pytest.raises(ProblemError) as refused:
            Problem(parameters=can, phi=0.3, bounces=1, effects=effects)
        assert (refused.value.key, refused.value.value) == ("effects.rim", rim)


@given(x=st.floats(-2, 2), y=st.floats(-2, 2), z=st.floats(-3, 3))
def test_a_point_mass_is_inside_the_can(x: float, y: float, z: float) -> None:
    effects = Effects(mass=Mass(share=0.1, x=x, y=y, z=z))
    outside = max(x * x + y * y, (z / PAPER_CAN.h) ** 2) - 1
    if outside < 0:
        Problem(parameters=PAPER_CAN, phi=0.3, bounces=1, effects=effects)
    elif outside > 1e-13:
        with pytest.raises(ProblemError) as refused:
            Problem(parameters=PAPER_CAN, phi=0.3, bounces=1, effects=effects)
        assert (refused.value.key, refused.value.value) == ("effects.mass", effects.mass)


@pytest.mark.parametrize(
    ("key", "declared"),
    [
        ("restitution", {"compliance": VALID[Compliance], "restitution": VALID[Restitution]}),
        ("contour", {"mu": 0.0, "contour": 0.1}),
        ("contour", {"contour": 0.1, "rolling_resistance": 0.1}),
        ("patch", {"mu": 0.3, "patch": 0.1, "drilling": 0.1}),
        ("patch", {"mu": 0.0, "patch": 0.1}),
    ],
)
def test_laws_that_exclude_each_other_are_refused_by_name(
    key: str, declared: dict[str, Any]
) -> None:
    with pytest.raises(EffectError) as refused:
        Effects(**declared)
    assert refused.value.key == key
