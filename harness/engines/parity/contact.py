"""Parity at the contact: what a declared spring, impact or resistance does, by one step each.

The can is balanced on its rim, the contact below its centre. A spring and a damper are read from
the force on a can at rest, and on one that sinks. A can that drills or rolls on the spot feels a
moment about the contact point; what its angular momentum loses in a step, less what gravity does,
is that moment, and over the normal force an arm. A can that falls on its rim leaves it at the speed
that the impact gives back. The probes know a `World` and no engine.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from harness.core.simulation import ParityRow
from harness.engines.base import Contact, Floats, World, signed_distance
from harness.engines.parity.free_flight import compare
from harness.engines.stepping.horizon import natural_time
from models.gravity import gravity_vector, shaking
from models.kinematics import quaternion, to_body
from models.mass import Body, body
from models.rim import arc_of, contact_offset
from models.scene import Scene
from models.state import Pose, Twist

_UP = np.array((0.0, 0.0, 1.0))
_NOTHING = np.zeros(3)

_DEPTHS = tuple(1e-7 * 1.6**step for step in range(28))
"""Of the radius: to just past an engine's slop."""

_OBLIQUE = np.array((math.cos(0.4), math.sin(0.4), 0.0))
"""An axis to roll about that is no axis of a friction pyramid."""

_FALLING = 10.0  # m/s: what gravity adds in a few steps is little beside it
_FEW = 40  # steps of a fall and an impact
_LIGHT = 0.01  # of the weight: with less, what a step misses is no longer small beside the arm
_SLOW = 20.0  # times the rate that the resistance could stop in one step


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Stand:
    """A can balanced on its rim where a world's collider touches."""

    world: World
    scene: Scene
    whole: Body
    timestep: float
    touching: Pose
    offset: Floats

    def press(self, depth: float, twist: Twist) -> Contact:
        """Return the contact that a step solves at a depth, m, from a motion."""
        position = self.touching.position - depth * _UP
        self.world.place(Pose(position=position, quaternion=self.touching.quaternion), twist)
        self.world.step()
        return self.world.contact()

    def moments(self, spin: Floats) -> Iterator[tuple[Floats, float]]:
        """Yield the plane's moment about the contact and the normal force, spun on the spot.

        Pressed harder and harder, up to the weight or as hard as the engine lets the can be.
        """
        weight = self.whole.mass * max(self.scene.gravity, 1.0)
        twist = Twist(velocity=-np.cross(spin, self.offset), angular_velocity=spin)
        for share in _DEPTHS:
            depth = share * self.scene.can.radius
            normal = float(self.press(depth, twist).force[2])
            if normal >= _LIGHT * weight:
                yield self._moment(depth, twist), normal
            if normal >= weight:
                return

    def _moment(self, depth: float, twist: Twist) -> Floats:
        """Return the plane's moment about the contact in the step that was just taken, N m."""
        start = Pose(
            position=self.touching.position - depth * _UP, quaternion=self.touching.quaternion
        )
        point = start.position + self.offset
        gained = self._momentum(self.world.pose(), self.world.twist(), point)
        gained = (gained - self._momentum(start, twist, point)) / self.timestep
        gravity = gravity_vector(self.scene) + shaking(self.scene, 0.0, self.timestep)
        moment: Floats = gained - np.cross(self._centre(start) - point, self.whole.mass * gravity)
        return moment

    def _centre(self, pose: Pose) -> Floats:
        centre: Floats = pose.position + _in_world(pose, self.whole.centre)
        return centre

    def _momentum(self, pose: Pose, twist: Twist, about: Floats) -> Floats:
        """Return the angular momentum about a point, kg m^2/s."""
        centre = self._centre(pose)
        velocity = twist.velocity + np.cross(twist.angular_velocity, centre - pose.position)
        spin = self.whole.inertia @ to_body(pose.quaternion, twist.angular_velocity)
        momentum: Floats = _in_world(pose, spin)
        return momentum + np.cross(centre - about, self.whole.mass * velocity)


def contact_laws(world: World, scene: Scene, timestep: float) -> Iterator[ParityRow]:
    """Probe each law of the contact that the scene declares."""
    effects = scene.effects
    if not {"compliance", "restitution", "drilling", "rolling_resistance"}.intersection(
        effects.declared()
    ):
        return
    stand = _stand(world, scene, timestep)
    if effects.compliance is not None:
        yield from _spring(stand, effects.compliance.stiffness, effects.compliance.damping)
    if effects.restitution is not None:
        yield _impact(stand, effects.restitution.coefficient)
    if effects.drilling is not None:
        yield _resistance(stand, "arm of drilling", effects.drilling.length, _UP)
    if effects.rolling_resistance is not None:
        length = effects.rolling_resistance.length
        yield _resistance(stand, "arm of rolling resistance", length, _OBLIQUE)


def _stand(world: World, scene: Scene, timestep: float) -> _Stand:
    """Return a can balanced on its rim, lowered to where this collider touches."""
    can = scene.can
    offset = contact_offset(can, can.balancing_angle, 0.0, arc=arc_of(scene.effects))
    tilted = quaternion(can.balancing_angle, 0.0, 0.0)
    pose = Pose(position=-offset[2] * _UP, quaternion=tilted)
    world.place(pose, Twist(velocity=_NOTHING, angular_velocity=_NOTHING))
    touching = Pose(position=pose.position - signed_distance(world) * _UP, quaternion=tilted)
    return _Stand(
        world=world,
        scene=scene,
        whole=body(scene),
        timestep=timestep,
        touching=touching,
        offset=offset,
    )


def _spring(stand: _Stand, stiffness: float, damping: float) -> Iterator[ParityRow]:
    """Read stiffness and damping from the force at rest and sinking."""
    depth = stand.whole.mass * stand.scene.gravity / stiffness
    # it needs a depth, gravity or not, at which the rim is in the plane and the can is not
    depth = min(max(depth, 1e-9 * stand.scene.can.radius), 0.1 * stand.scene.can.radius)
    still = Twist(velocity=_NOTHING, angular_velocity=_NOTHING)
    held = stand.press(depth, still)
    speed = 0.01 * depth / stand.timestep
    sinking = stand.press(depth, Twist(velocity=-speed * _UP, angular_velocity=_NOTHING))
    # an engine that takes the spring at the end of the step has it damp by k dt as well, and feels
    # what the can has fallen by then; a soft constraint misses the law by its impedance, 1e-4
    step = stiffness * stand.timestep
    fallen = step * stand.timestep / stand.whole.mass
    how = "force of one step on a can balanced on its rim"
    yield compare(
        "contact stiffness",
        "N/m",
        stiffness,
        float(held.force[2]) / depth,
        stiffness * (1e-3 + 3.0 * fallen),
        f"{how}, at rest",
    )
    yield compare(
        "contact damping",
        "N s/m",
        damping,
        float(sinking.force[2] - held.force[2]) / speed,
        1e-3 * damping + 1.1 * step + 6.0 * fallen * (damping + step) + 1e-6 * step,
        f"{how}, that sinks at {speed:.2g} m/s",
    )


def _resistance(stand: _Stand, quantity: str, length: float, axis: Floats) -> ParityRow:
    """Read the arm of a moment that turning about an axis meets."""
    moments = np.linalg.eigvalsh(stand.whole.inertia)
    stopped = length * stand.whole.mass * max(stand.scene.gravity, 1.0) * stand.timestep
    spin = (1.0 + _SLOW * stopped / moments[0]) * axis
    arms = [
        (abs(float(moment[2])) if axis is _UP else math.hypot(moment[0], moment[1])) / normal
        for moment, normal in stand.moments(spin)
    ]
    return compare(
        quantity,
        "m",
        length,
        # pressed lightly, the friction that keeps a turning can on the spot has a large share of a
        # cone that the moment shares with it; pressed hard, a soft one holds back less than it may
        max(arms, default=math.nan),
        # a cone that is shared with sliding is short of what the spin slides within the step
        length * (1e-3 + 50.0 * (stand.timestep / natural_time(stand.scene)) ** 2),
        "moment over the normal force, in one step of turning on the spot, at the best load",
    )


def _impact(stand: _Stand, coefficient: float) -> ParityRow:
    """Read what an impact gives back of the speed of the contact."""
    world, timestep = stand.world, stand.timestep
    above = 2.5 * _FALLING * timestep
    world.place(
        Pose(position=stand.touching.position + above * _UP, quaternion=stand.touching.quaternion),
        Twist(velocity=-_FALLING * _UP, angular_velocity=_NOTHING),
    )
    before = after = -_FALLING
    for _ in range(_FEW):
        world.step()
        twist = world.twist()
        after = float((twist.velocity + np.cross(twist.angular_velocity, stand.offset))[2])
        if world.contact().force[2] > 0.0:
            break
        before = after
    # gravity acts in the step of the impact too
    slack = stand.scene.gravity * timestep / _FALLING
    return compare(
        "restitution",
        "1",
        coefficient,
        -after / before,
        1e-6 + 2.0 * slack,
        f"an impact at {_FALLING:g} m/s, balanced on its rim",
    )


def _in_world(pose: Pose, vector: Floats) -> Floats:
    back = pose.quaternion * np.array((1.0, -1.0, -1.0, -1.0))
    return to_body(back, vector)
