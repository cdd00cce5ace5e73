"""Limits of the scenes that are run: beyond the hardest case in the catalogue, but finite.

A scene file may hold any finite number. A can as large as the solar system overflows doubles, and a
million seconds of a spin take days to compute; both are refused before anything runs, with the
allowed range.
"""

import math
from collections.abc import Iterator

from harness.core.errors import HarnessError
from models.scene import Scene

MASS = (1e-9, 1e9)
"""kg."""

RADIUS = (1e-6, 1e3)
"""m."""

GRAVITY = (1e-9, 1e6)
"""m/s^2, or zero."""

TRANSVERSE = (1e-3, 1e4)
"""a, over m R^2."""

AXIAL = (1e-9, 1e4)
"""c, over m R^2."""

HEIGHT = (1e-4, 1e3)
"""h, over R."""

FLATTEST = 1e-12
"""rad."""

LARGEST_ANGLE = 1e6
"""rad, of psi and theta at the release."""

FASTEST = 1e4
"""Rates at the release, over sqrt(g/R)."""

LONGEST = 1e4
"""sqrt(R/g)."""

MOST_TURNED = 1e4
"""rad, by the rates at the release within the horizon."""

MOST_FALLS = 2e3
"""Bounces from the nutation of the release, each a megabyte of motion, in a horizon in seconds."""

FARTHEST = 1e3
"""Height of the release, and amplitudes of a shaken plane, over R."""


class SceneLimitError(HarnessError, ValueError):
    """A scene with a value beyond the limits of what is run.

    Parameters
    ----------
    scene, key : str
    value : float
    allowed : str
        What is allowed, to be read after "must be".
    """

    def __init__(self, scene: str, key: str, value: float, allowed: str) -> None:
        super().__init__(scene, key, value, allowed)
        self.scene, self.key, self.value, self.allowed = scene, key, value, allowed

    def __str__(self) -> str:
        """Return the value and the allowed values in a sentence."""
        return (
            f"scene '{self.scene}': '{self.key}' is {self.value:g}, but to be run must be "
            f"{self.allowed}"
        )


def check_scene_limits(scene: Scene) -> None:
    """Refuse a scene beyond the limits.

    Raises
    ------
    SceneLimitError
    """
    for key, value, allowed in _beyond(scene):
        raise SceneLimitError(scene.name, key, value, allowed)


def _beyond(scene: Scene) -> Iterator[tuple[str, float, str]]:
    """Yield key, value and allowed range of each value beyond the limits.

    A later check relies on the earlier ones.
    """
    can, release = scene.can, scene.release
    yield from _within("can.mass", can.mass, MASS, 1.0, "kg")
    yield from _within("can.radius", can.radius, RADIUS, 1.0, "m")
    if scene.gravity > 0.0:
        yield from _within("gravity", scene.gravity, GRAVITY, 1.0, "m/s^2, or zero")
    unit = can.mass * can.radius * can.radius
    yield from _within("can.A", can.transverse_inertia, TRANSVERSE, unit, "kg m^2")
    yield from _within("can.C", can.axial_inertia, AXIAL, unit, "kg m^2")
    yield from _within("can.H", can.half_height, HEIGHT, can.radius, "m")
    if release.phi < FLATTEST:
        yield "release.phi", release.phi, f"at least {FLATTEST:g} rad"
    for key in ("psi", "theta"):
        yield from _small(f"release.{key}", getattr(release, key), LARGEST_ANGLE, "rad")
    yield from _small("release.height", release.height, FARTHEST * can.radius, "m")
    seconds = scene.horizon.seconds
    rates = (release.phi_dot, release.psi_dot, release.theta_dot)
    if scene.gravity > 0.0:
        time = math.sqrt(can.radius / scene.gravity)
        for key, rate in zip(("phi_dot", "psi_dot", "theta_dot"), rates, strict=True):
            yield from _small(f"release.{key}", rate, FASTEST / time, "rad/s")
        yield from _shaken(scene, FASTEST / time)
        # from rest at a small phi the can falls flat within sqrt(2 (a_p + 1) phi)
        fall = 2.0 * math.sqrt(2.0 * (can.a + can.h**2 + 1.0) * release.phi)
        most = min(LONGEST, MOST_FALLS * fall) * time
        if seconds is not None and seconds > most:
            yield "horizon.seconds", seconds, f"at most {most:.3g} s: {MOST_FALLS:g} bounces"
    turned = max(map(abs, rates)) * (seconds or 0.0)
    if seconds is not None and turned > MOST_TURNED:
        most = seconds * MOST_TURNED / turned
        yield "horizon.seconds", seconds, f"at most {most:.3g} s at the rates of its release"


def _shaken(scene: Scene, fastest: float) -> Iterator[tuple[str, float, str]]:
    shake, key = scene.effects.shake, "effects.shake"
    if shake is None:
        return
    yield from _small(f"{key}.frequency", shake.frequency, fastest / (2.0 * math.pi), "Hz")
    for name in ("horizontal", "vertical"):
        amplitude = getattr(shake, name)
        yield from _small(f"{key}.{name}", amplitude, FARTHEST * scene.can.radius, "m")


def _within(
    key: str, value: float, ends: tuple[float, float], unit: float, name: str
) -> Iterator[tuple[str, float, str]]:
    low, high = (end * unit for end in ends)
    if not low <= value <= high:
        yield key, value, f"from {low:g} to {high:g} {name}"


def _small(key: str, value: float, most: float, unit: str) -> Iterator[tuple[str, float, str]]:
    if abs(value) > most:
        yield key, value, f"at most {most:g} {unit} in size"
