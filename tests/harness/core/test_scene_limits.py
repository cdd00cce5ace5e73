"""How extreme a scene may be to be run, just inside and just outside each limit.

The limits are written out here as the messages state them, and not imported: whoever changes one is
told.
"""

import math
from dataclasses import replace

import pytest

from harness.core.scene_limits import SceneLimitError, check_scene_limits
from models import Can, Effects, Horizon, Release, Scene, Shake, load

PLAIN = replace(load("gentle-rock"), horizon=Horizon(bounces=1))
CAN = PLAIN.can
NATURAL = math.sqrt(CAN.radius / PLAIN.gravity)
"""sqrt(R/g), s."""
INSIDE, OUTSIDE = 1.0 - 1e-6, 1.0 + 1e-6


def refused(scene: Scene) -> str:
    """Return the key that a scene is refused for; empty if it is not."""
    try:
        check_scene_limits(scene)
    except SceneLimitError as error:
        return error.key
    return ""


def allowed(scene: Scene) -> str:
    """Return what is allowed instead of what a scene is refused for."""
    with pytest.raises(SceneLimitError) as caught:
        check_scene_limits(scene)
    return caught.value.allowed


def with_can(**groups: float) -> Scene:
    """Return the scene with another can."""
    own = {"mass": CAN.mass, "radius": CAN.radius, "a": CAN.a, "c": CAN.c, "h": CAN.h}
    return replace(PLAIN, can=Can.from_groups(**(own | groups)))


@pytest.mark.parametrize(
    ("key", "name", "ends", "others"),
    [
        ("can.mass", "mass", (1e-9, 1e9), {}),
        ("can.radius", "radius", (1e-6, 1e3), {}),
        ("can.A", "a", (1e-3, 1e4), {"c": 1e-3}),
        ("can.C", "c", (1e-9, 1e4), {"a": 9e3}),
        ("can.H", "h", (1e-4, 1e3), {}),
    ],
)
def test_a_can_is_within_both_ends(
    key: str, name: str, ends: tuple[float, float], others: dict[str, float]
) -> None:
    low, high = ends
    for value in (low * OUTSIDE, high * INSIDE):
        assert refused(with_can(**others, **{name: value})) == ""
    for value in (low * INSIDE, high * OUTSIDE):
        assert refused(with_can(**others, **{name: value})) == key


def test_gravity_is_within_both_ends_or_zero() -> None:
    for value in (0.0, 1e-9 * OUTSIDE, 1e6 * INSIDE):
        still = replace(PLAIN.release, psi_dot=0.0, theta_dot=0.0)
        horizon = Horizon(seconds=1.0) if value == 0.0 else PLAIN.horizon
        assert refused(replace(PLAIN, gravity=value, release=still, horizon=horizon)) == ""
    for value in (1e-9 * INSIDE, 1e6 * OUTSIDE):
        assert refused(replace(PLAIN, gravity=value)) == "gravity"


@pytest.mark.parametrize(
    ("key", "most"),
    [
        ("psi", 1e6),
        ("theta", 1e6),
        ("height", 1e3 * CAN.radius),
        ("phi_dot", 1e4 / NATURAL),
        ("psi_dot", 1e4 / NATURAL),
        ("theta_dot", 1e4 / NATURAL),
    ],
)
def test_a_release_is_no_larger_than_it_may_be(key: str, most: float) -> None:
    for sign in (1.0, -1.0) if key != "height" else (1.0,):

        def released(value: float, sign: float = sign) -> Scene:
            release = replace(PLAIN.release, **{key: sign * value})
            return replace(PLAIN, release=release)

        assert refused(released(most * INSIDE)) == ""
        assert refused(released(most * OUTSIDE)) == f"release.{key}"


def test_a_release_is_a_trillionth_of_a_radian_off_flat() -> None:
    def leaning(phi: float) -> Scene:
        return replace(PLAIN, release=Release(phi=phi))

    assert refused(leaning(1e-12)) == ""
    assert refused(leaning(1e-12 * INSIDE)) == "release.phi"
    assert allowed(leaning(1e-12 * INSIDE)) == "at least 1e-12 rad"


@pytest.mark.parametrize(("phi", "most"), [(1.0, 1e4), (1e-2, None)])
def test_a_run_lasts_ten_thousand_natural_times_or_two_thousand_falls(
    phi: float, most: float | None
) -> None:
    # a can falls flat from a small phi within sqrt(2 (a_p + 1) phi), and rises as long
    fall = math.sqrt(2.0 * (CAN.a + CAN.h**2 + 1.0) * phi)
    longest = NATURAL * (2000.0 * 2.0 * fall if most is None else most)

    def lasting(seconds: float) -> Scene:
        return replace(PLAIN, release=Release(phi=phi), horizon=Horizon(seconds=seconds))

    assert (2000.0 * 2.0 * fall < 1e4) is (most is None)
    assert refused(lasting(longest * INSIDE)) == ""
    assert refused(lasting(longest * OUTSIDE)) == "horizon.seconds"
    assert "2000 bounces" in allowed(lasting(longest * OUTSIDE))


@pytest.mark.parametrize("key", ["phi_dot", "psi_dot", "theta_dot"])
def test_a_release_turns_by_ten_thousand_radians_within_the_horizon(key: str) -> None:
    def turning(angle: float) -> Scene:
        release = replace(Release(phi=0.5), **{key: -angle / 2.0})
        return replace(PLAIN, release=release, horizon=Horizon(seconds=2.0))

    assert refused(turning(1e4 * INSIDE)) == ""
    assert refused(turning(1e4 * OUTSIDE)) == "horizon.seconds"
    assert "at the rates of its release" in allowed(turning(1e4 * OUTSIDE))


@pytest.mark.parametrize(
    ("key", "largest"),
    [
        ("frequency", 1e4 / NATURAL / (2.0 * math.pi)),
        ("horizontal", 1e3 * CAN.radius),
        ("vertical", 1e3 * CAN.radius),
    ],
)
def test_a_plane_is_shaken_within_limits(key: str, largest: float) -> None:
    def shaken(value: float) -> Scene:
        shake = replace(Shake(frequency=1.0, horizontal=1e-3), **{key: value})
        return replace(PLAIN, effects=Effects(shake=shake))

    assert refused(shaken(largest * INSIDE)) == ""
    assert refused(shaken(largest * OUTSIDE)) == f"effects.shake.{key}"
