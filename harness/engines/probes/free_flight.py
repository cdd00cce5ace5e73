"""Free flight without gravity, where nothing acts: damping, velocity clamps, limits of a turn.

A velocity v is kept for ever. What one step of dt takes from it, (v - v')/(v dt), is the rate of a
damping; a law k_1 + k_2 |v| is linear and quadratic damping. The spin about the symmetry axis, a
principal axis, is kept likewise, and turns the can in a step by omega dt, however much that is.
"""

import math
from collections.abc import Iterator

import numpy as np

from harness.core.case import Case
from harness.engines.base import World
from harness.engines.probes.fixture import (
    ALOFT,
    UPRIGHT,
    Evidence,
    Opener,
    ProbeFinding,
    Trace,
    aloft,
)
from models.kinematics import half_angles
from models.state import Pose, Twist

RATES = (1.0, 3.0, 10.0, 30.0)
"""m/s and rad/s: below every clamp known."""

FAST = 1e4
"""m/s and rad/s: beyond what a scene of a metre reaches short of 1 mm cans."""

LADDER = tuple(FAST * share for share in (0.003, 0.01, 0.03, 0.1, 0.3, 1.0))
"""m/s and rad/s: a strong damping takes the greatest away in one step, a clamp does not."""

TURNS = (0.1, 0.3, 0.5, 0.7, 0.8, 1.0, 1.5, 2.0, 3.0)
"""rad in one step; past pi a turn cannot be told from its complement."""

_EXACT = 1e-9
"""Relative error up to which a turn counts as exact: round-off is 1e-15, a law of second order at
a tenth of a radian 1e-3."""

_KINDS = (("velocity", "m/s", "1/m"), ("spin", "rad/s", "1/rad"))


def damping(engine: Opener, case: Case) -> Iterator[Evidence]:
    """Yield the rates of linear and quadratic damping of velocity and of spin."""
    world, dt = aloft(engine, case), engine.timestep(case)
    for kind, unit, per in _KINDS:
        rates = [(given - _after(world, kind, given)) / (given * dt) for given in RATES]
        quadratic, linear = np.polyfit(RATES, rates, 1)
        # a rate is known to an ulp of the velocity over the timestep
        noise = 8.0 * 2.0**-52 / dt
        for law, value, in_unit in (("linear", linear, "1/s"), ("quadratic", quadratic, per)):
            yield ProbeFinding(
                effect="damping",
                quantity=f"{law} damping of {kind}",
                unit=in_unit,
                value=0.0 if abs(value) <= noise else float(value),
                expected=0.0,
                how=f"loss in one step of free flight at 1 to 30 {unit}",
            )


def clamp(engine: Opener, case: Case) -> Iterator[Evidence]:
    """Yield the greatest velocity and the greatest spin that a step leaves."""
    world = aloft(engine, case)
    for kind, unit, _ in _KINDS:
        yield ProbeFinding(
            effect="velocity clamp",
            quantity=f"greatest {kind} left by a step",
            unit=unit,
            value=max(abs(_after(world, kind, given)) for given in LADDER),
            expected=FAST,
            how=f"one step of free flight at 30 to 10,000 {unit}",
        )


def turn(engine: Opener, case: Case) -> Iterator[Evidence]:
    """Yield how far a step turns the can that should turn it far."""
    world, dt = aloft(engine, case), engine.timestep(case)
    asked, turned = [], []
    for angle in TURNS:
        spin = _after(world, "spin", angle / dt)
        phi, sigma, _ = half_angles(world.pose().quaternion)
        # both halves of the quaternion are in sigma while the can is upright
        turned.append(float(sigma) % (2.0 * math.pi) if phi < 1.0 else math.nan)
        asked.append(spin * dt)
    largest = int(np.argmax(asked))
    exact = [a for a, t in zip(asked, turned, strict=True) if abs(t / a - 1.0) <= _EXACT]
    for quantity, unit, value, expected in (
        ("turn of the orientation in a step", "rad", turned[largest], asked[largest]),
        ("largest turn in a step that is exact", "rad", max(exact, default=0.0), asked[largest]),
    ):
        yield ProbeFinding(
            effect="orientation update",
            quantity=quantity,
            unit=unit,
            value=value,
            expected=expected,
            how="one step of free flight at a spin that the engine lets pass",
        )
    yield Trace(
        effect="orientation update",
        x_label="spin times timestep [rad]",
        y_label="turn of the orientation [rad]",
        x=np.array(asked),
        y=np.array(turned),
    )


def _after(world: World, kind: str, given: float) -> float:
    """Return what one step of free flight leaves of a velocity (m/s) or of a spin (rad/s)."""
    axis = np.array((1.0, 0.0, 0.0)) if kind == "velocity" else np.array((0.0, 0.0, 1.0))
    moving, nothing = given * axis, np.zeros(3)
    velocity, spin = (moving, nothing) if kind == "velocity" else (nothing, moving)
    world.place(
        Pose(position=np.array((0.0, 0.0, ALOFT)), quaternion=UPRIGHT),
        Twist(velocity=velocity, angular_velocity=spin),
    )
    world.step()
    after = world.twist()
    return float((after.velocity if kind == "velocity" else after.angular_velocity) @ axis)
