"""Parity at the contact: friction, spring, impact and resistance, probed in single steps.

The can is balanced on its rim, the contact below its centre. Friction is measured on a can that
slides. A spring and a damper are read from the force on a can at rest, and on one that sinks. A can
that drills or rolls on the spot feels a moment about the contact point; what its angular momentum
loses in a step, less what gravity does, is that moment, and over the normal force an arm. A can
that falls on its rim leaves it at the speed that the impact gives back. The probes know a `World`
and no engine.
"""

import math
from collections.abc import Iterator
from itertools import product
from typing import TypeAlias

import numpy as np

from harness.engines.base import Contact, Floats, World
from harness.engines.stepping.horizon import natural_time
from harness.engines.stepping.settling import (
    AT_REST,
    UP,
    X,
    Y,
    low_point,
    lowered,
    moving,
    stepped,
    touching_pose,
)
from models import NO_SLIP_FRICTION, Pose, Scene, Twist, contact_offset, to_body
from models.gravity import gravity_vector, shaking
from models.kinematics import to_world
from models.mass import body
from models.rim import arc_of

Compared: TypeAlias = tuple[str, str, float, float, float, str]
"""Quantity, unit, the scene's value, the engine's, the allowed difference, and the probe."""

_SHALLOW, _DEEPER = 1e-6, 1.2  # of the radius, and from one depth to the next
_DEEP = 1e-3  # of the radius, and at least _SLOP
_SLOP = 5e-5  # m: engines leave less than this alone, however small the can
_SLIDING = 10.0  # m/s, at least

_DEPTHS = tuple(1e-7 * 1.6**step for step in range(28))
"""Of the radius: to just past an engine's slop."""

_OBLIQUE = np.array((math.cos(0.4), math.sin(0.4), 0.0))
"""An axis to roll about that is no axis of a friction pyramid."""

_FALLING = 10.0  # m/s: much more than gravity adds in a few steps
_FEW = 40  # steps of a fall and an impact
_LIGHT = 0.01  # of the weight: with less, the error of a step is no longer small over the arm
_SLOW = 20.0  # times the rate that the resistance could stop in one step


class Stand:
    """A can balanced on its rim where the collider of a world touches the plane."""

    def __init__(self, world: World, scene: Scene, timestep: float) -> None:
        can, arc = scene.can, arc_of(scene.effects)
        self.world, self.scene, self.timestep = world, scene, timestep
        self.body = body(scene)
        self.touching = touching_pose(world, can, can.balancing_angle, arc)
        self.offset = contact_offset(can, can.balancing_angle, 0.0, arc=arc)

    def press(self, depth: float, twist: Twist) -> Contact:
        """Return the contact that a step solves at a depth, m, from a motion."""
        return stepped(self.world, lowered(self.touching, depth), twist).contact()

    def moments(self, spin: Floats) -> Iterator[tuple[Floats, float]]:
        """Yield the plane's moment about the contact and the normal force, spun on the spot.

        Pressed harder and harder, up to the weight or as hard as the engine lets the can be.
        """
        weight = self.body.mass * max(self.scene.gravity, 1.0)
        twist = moving(-np.cross(spin, self.offset), spin)
        for share in _DEPTHS:
            depth = share * self.scene.can.radius
            normal = float(self.press(depth, twist).force[2])
            if normal >= _LIGHT * weight:
                yield self._moment(depth, twist), normal
            if normal >= weight:
                return

    def _moment(self, depth: float, twist: Twist) -> Floats:
        """Return the plane's moment about the contact in the step that was just taken, N m."""
        start = lowered(self.touching, depth)
        point = start.position + self.offset
        gained = self._momentum(self.world.pose(), self.world.twist(), point)
        gained = (gained - self._momentum(start, twist, point)) / self.timestep
        gravity = gravity_vector(self.scene) + shaking(self.scene, 0.0, self.timestep)
        moment: Floats = gained - np.cross(self._centre(start) - point, self.body.mass * gravity)
        return moment

    def _centre(self, pose: Pose) -> Floats:
        centre: Floats = pose.position + to_world(pose.quaternion, self.body.centre)
        return centre

    def _momentum(self, pose: Pose, twist: Twist, about: Floats) -> Floats:
        """Return the angular momentum about a point, kg m^2/s."""
        centre = self._centre(pose)
        velocity = twist.velocity + np.cross(twist.angular_velocity, centre - pose.position)
        spin = self.body.inertia @ to_body(pose.quaternion, twist.angular_velocity)
        momentum: Floats = to_world(pose.quaternion, spin)
        return momentum + np.cross(centre - about, self.body.mass * velocity)


def friction(stand: Stand) -> Compared:
    """Probe the friction of the pair: a can that slides fast takes all of it."""
    scene, can, slip = stand.scene, stand.scene.can, stand.scene.effects.slip
    declared = NO_SLIP_FRICTION if slip is None else slip.mu
    # along the lean friction turns the can about a transverse axis only, whose moment is never
    # small; and twice as fast as the friction of one step under gravity can stop
    mobility = 1.0 + can.mass * low_point(can, can.balancing_angle) ** 2 / can.transverse_inertia
    speed = max(_SLIDING, 2.0 * declared * mobility * scene.gravity * stand.timestep)
    # solvers stop at a tolerance of this size or less; where the contact resists turning too, the
    # moment may share the cone with the force: the force is short by half its share squared
    tolerance = max(declared, 1e-3) * (1e-6 if contact_turns_freely(scene) else 1e-2)
    # in small steps: just past an engine's slop, since a force that stops the can within the step
    # needs less friction than there is
    deepest = max(_DEEP * can.radius, _SLOP)
    count = math.ceil(math.log(deepest / (_SHALLOW * can.radius), _DEEPER)) + 1
    depths = _SHALLOW * can.radius * _DEEPER ** np.arange(count)

    def slid(speed: float) -> float:
        # with a heavy point mass friction along the lean may lift the rim, or jam it (Painleve):
        # then friction across is measured
        for way, depth in product((X, Y), depths.tolist()):
            force = stand.press(depth, moving(speed * way)).force
            if force[2] > 0.0:
                return math.hypot(force[0], force[1]) / float(force[2])
        return math.nan

    # friction that is soft takes all of its cone from a speed on that grows with the load
    for faster in (speed, speed * 10.0, speed * 10.0 * 10.0):
        ratio = slid(faster)
        if ratio >= declared - tolerance or math.isnan(ratio):
            break
    how = f"force ratio of a can that slides at {faster:g} m/s, balanced on its rim"
    return "friction of the pair", "1", declared, ratio, tolerance, how


def contact_turns_freely(scene: Scene) -> bool:
    """Whether the plane resists neither drilling nor rolling."""
    return scene.effects.drilling is None and scene.effects.rolling_resistance is None


def contact_laws(stand: Stand) -> Iterator[Compared]:
    """Probe each law of the contact that the scene declares."""
    effects = stand.scene.effects
    if effects.compliance is not None:
        yield from _spring(stand, effects.compliance.stiffness, effects.compliance.damping)
    if effects.restitution is not None:
        yield _impact(stand, effects.restitution.coefficient)
    if effects.drilling is not None:
        yield _resistance(stand, "drilling", effects.drilling.length, UP)
    if effects.rolling_resistance is not None:
        length = effects.rolling_resistance.length
        yield _resistance(stand, "rolling resistance", length, _OBLIQUE)


def _spring(stand: Stand, stiffness: float, damping: float) -> Iterator[Compared]:
    """Read stiffness and damping from the force at rest and sinking."""
    depth = stand.body.mass * stand.scene.gravity / stiffness
    # it needs a depth, gravity or not, at which the rim is in the plane and the can is not
    depth = min(max(depth, 1e-9 * stand.scene.can.radius), 0.1 * stand.scene.can.radius)
    speed = 0.01 * depth / stand.timestep
    held = float(stand.press(depth, AT_REST).force[2])
    sinking = float(stand.press(depth, moving(-speed * UP)).force[2])
    # an engine that takes the spring at the end of the step has it damp by k dt as well, and feels
    # what the can has fallen by then; a soft constraint misses the law by its impedance, 1e-4
    step = stiffness * stand.timestep
    fallen = step * stand.timestep / stand.body.mass
    how, tolerance = "force of one step on a can balanced on its rim", 1e-3 + 3.0 * fallen
    yield (
        "contact stiffness",
        "N/m",
        stiffness,
        held / depth,
        stiffness * tolerance,
        f"{how}, at rest",
    )
    rate, how = (sinking - held) / speed, f"{how}, that sinks at {speed:.2g} m/s"
    tolerance = 1e-3 * damping + 1.1 * step + 6.0 * fallen * (damping + step) + 1e-6 * step
    yield "contact damping", "N s/m", damping, rate, tolerance, how


def _resistance(stand: Stand, name: str, length: float, axis: Floats) -> Compared:
    """Read the arm of a moment that turning about an axis meets."""
    moments = np.linalg.eigvalsh(stand.body.inertia)
    stopped = length * stand.body.mass * max(stand.scene.gravity, 1.0) * stand.timestep
    spin = (1.0 + _SLOW * stopped / moments[0]) * axis
    arms = [
        (abs(float(moment[2])) if axis is UP else math.hypot(moment[0], moment[1])) / normal
        for moment, normal in stand.moments(spin)
    ]
    # pressed lightly, the friction that keeps a turning can on the spot has a large share of a cone
    # that the moment shares with it; pressed hard, a soft one holds back less than it may
    best = max(arms, default=math.nan)
    # a cone that is shared with sliding is short of what the spin slides within the step
    tolerance = length * (1e-3 + 50.0 * (stand.timestep / natural_time(stand.scene)) ** 2)
    how = "moment over the normal force, in one step of turning on the spot, at the best load"
    return f"arm of {name}", "m", length, best, tolerance, how


def _impact(stand: Stand, coefficient: float) -> Compared:
    """Read what an impact gives back of the speed of the contact."""
    world, timestep = stand.world, stand.timestep
    world.place(lowered(stand.touching, -2.5 * _FALLING * timestep), moving(-_FALLING * UP))
    before = after = -_FALLING
    for _ in range(_FEW):
        world.step()
        twist = world.twist()
        after = float((twist.velocity + np.cross(twist.angular_velocity, stand.offset))[2])
        if world.contact().force[2] > 0.0:
            break
        before = after
    # gravity acts in the step of the impact too
    tolerance = 1e-6 + 2.0 * (stand.scene.gravity * timestep / _FALLING)
    how = f"an impact at {_FALLING:g} m/s, balanced on its rim"
    return "restitution", "1", coefficient, -after / before, tolerance, how
