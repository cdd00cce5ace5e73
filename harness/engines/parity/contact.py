"""Parity at the contact: friction, spring, impact and resistance, probed in single steps.

The can is balanced on its rim, the contact below its centre. Friction is measured on a can that
slides. A spring and a damper are read from the force on a can at rest, and on one that sinks. A can
that drills or rolls on the spot feels a moment about the contact point; what its angular momentum
loses in a step, less what gravity does, is that moment, and over the normal force an arm. A can
that falls on its rim leaves it at the speed that the impact gives back. The probes know a `World`
and no engine.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import count, islice, pairwise, product
from types import MappingProxyType
from typing import TypeAlias

import numpy as np

from harness.engines.description import Precision
from harness.engines.stepping.horizon import natural_time
from harness.engines.stepping.settling import (
    AT_REST,
    UP,
    X,
    Y,
    low_point,
    lowered,
    moving,
    touching_pose,
)
from harness.engines.world import Contact, Floats, World
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

_SLIDE = 64  # steps
_STEADY = 1e-2
"""Change of the load from step to step up to which it counts as steady, and the error of a friction
that goes with the load of the step before, relative."""

_DEPTHS = tuple(1e-7 * 1.6**step for step in range(28))
"""Of the radius: to just past an engine's slop."""

_OBLIQUE = np.array((math.cos(0.4), math.sin(0.4), 0.0))
"""A direction to slide in, or an axis to roll about, that is none of a friction pyramid."""

_FALLING = 10.0  # m/s: much more than gravity adds in a few steps
_FEW = 40  # steps of a fall and an impact
_LIGHT = 0.01  # of the weight: with less, the error of a step is no longer small over the arm
_ROUNDINGS = 16.0  # of momenta: a change of frame, products and sums
_SLOW = 20.0  # times the rate that the resistance could stop in one step


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundOff:
    """How closely the numbers of an engine are known, relative.

    Parameters
    ----------
    epsilon : float
        Distance from 1 to the next number.
    read : float
        Of what is read back, and of lengths over the size of the can: decimal text and a change of
        frame cost some roundings.
    probed : float
        Of what a step of free flight changes.
    solved : float
        Tolerance at which a contact solver stops.
    """

    epsilon: float
    read: float
    probed: float
    solved: float


ROUND_OFF: Mapping[Precision, RoundOff] = MappingProxyType(
    {
        Precision.DOUBLE: RoundOff(
            epsilon=Precision.DOUBLE.epsilon, read=1e-12, probed=1e-9, solved=1e-6
        ),
        # eight roundings, and eighty of a difference of velocities or of a ratio of forces
        Precision.SINGLE: RoundOff(
            epsilon=Precision.SINGLE.epsilon, read=1e-6, probed=1e-5, solved=1e-5
        ),
    }
)


class Stand:
    """A can balanced on its rim where the collider of a world touches the plane."""

    def __init__(
        self,
        world: World,
        scene: Scene,
        timestep: float,
        known: RoundOff = ROUND_OFF[Precision.DOUBLE],
        *,
        tells_forces: bool = True,
    ) -> None:
        can, arc = scene.can, arc_of(scene.effects)
        self.world, self.scene, self.timestep, self.known = world, scene, timestep, known
        self.body, self._tells_forces = body(scene), tells_forces
        self.touching = touching_pose(world, can, can.balancing_angle, arc)
        self.offset = contact_offset(can, can.balancing_angle, 0.0, arc=arc)

    def press(self, depth: float, twist: Twist) -> Contact:
        """Return the contact that a step solves at a depth, m, from a motion."""
        return next(self.pressed(depth, twist))

    def pressed(self, depth: float, twist: Twist) -> Iterator[Contact]:
        """Yield the contact of one step after the other from a depth, m, and a motion."""
        self.world.place(lowered(self.touching, depth), twist)
        for step in count():
            before = None if self._tells_forces else self._impulse()
            self.world.step()
            contact = self.world.contact()
            if before is not None:
                gravity = gravity_vector(self.scene)
                gravity = gravity + shaking(self.scene, step * self.timestep, self.timestep)
                gained = (self._impulse() - before) / self.timestep
                contact = replace(contact, force=gained - self.body.mass * gravity)
            yield contact

    def _impulse(self) -> Floats:
        """Return the momentum, kg m/s."""
        pose, twist = self.world.pose(), self.world.twist()
        arm = self._centre(pose) - pose.position
        momentum: Floats = self.body.mass * (twist.velocity + np.cross(twist.angular_velocity, arm))
        return momentum

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


FRICTIONS = ("friction of the pair", "friction between the axes")

TWO_DIRECTIONS = math.sqrt(2.0) - 1.0 + 0.005
"""Share by which friction in two directions of their own exceeds the declared one between them, and
the thousandths that solvers miss."""


def bounded_separately(scene: Scene) -> dict[str, float]:
    """Return how far friction goes astray in two directions, of the load without any friction.

    Below the centre of a can friction does not change the load but for what a slope adds, less than
    a hundredth; beside a centre of mass that is elsewhere it does, to any size.
    """
    if scene.effects.point_mass is not None:
        return dict.fromkeys(FRICTIONS, math.inf)
    return dict(zip(FRICTIONS, (0.01, TWO_DIRECTIONS), strict=True))


def declared_friction(scene: Scene) -> float:
    """Return the coefficient of friction of a scene, or that of a pair which never slips."""
    slip = scene.effects.slip
    return NO_SLIP_FRICTION if slip is None else slip.mu


def friction(stand: Stand) -> Iterator[Compared]:
    """Probe the friction of the pair: a can that slides fast takes all of it, whichever way.

    Along the axes of the plane two directions of friction of their own are no different from a
    cone; between them they reach up to 1.41 of what is declared, or as much less.
    """
    along, between = FRICTIONS
    yield _sliding(stand, along, (X, Y), "")
    way = (_OBLIQUE, np.cross(UP, _OBLIQUE))
    yield _sliding(stand, between, way, " at 0.4 rad to an axis")


def _sliding(stand: Stand, quantity: str, ways: tuple[Floats, Floats], where: str) -> Compared:
    """Probe the friction of a can that slides in the first of two ways that has a force."""
    scene, can, declared = stand.scene, stand.scene.can, declared_friction(stand.scene)
    # twice as fast as the friction of one step under gravity can stop
    least = float(np.linalg.eigvalsh(stand.body.inertia)[0])
    mobility = 1.0 + can.mass * low_point(can, can.balancing_angle) ** 2 / least
    speed = max(_SLIDING, 2.0 * declared * mobility * scene.gravity * stand.timestep)
    # solvers stop at a tolerance of this size or less; where the contact resists turning too, the
    # moment may share the cone with the force: the force is short by half its share squared
    free = contact_turns_freely(scene)
    tolerance = max(declared, 1e-3) * (stand.known.solved if free else 1e-2)
    # in small steps: just past an engine's slop, since a force that stops the can within the step
    # needs less friction than there is
    deepest = max(_DEEP * can.radius, _SLOP)
    most = math.ceil(math.log(deepest / (_SHALLOW * can.radius), _DEEPER)) + 1
    depths = _SHALLOW * can.radius * _DEEPER ** np.arange(most)

    def slid(speed: float) -> float:
        # with a heavy point mass friction along the lean may lift the rim, or jam it (Painleve):
        # then friction across is measured
        for way, depth in product(ways, depths.tolist()):
            force = stand.press(depth, moving(speed * way)).force
            if force[2] > 0.0:
                return math.hypot(force[0], force[1]) / float(force[2])
        return math.nan

    # friction that is soft takes all of its cone from a speed on that grows with the load
    for faster in (speed, speed * 10.0, speed * 10.0 * 10.0):
        ratio = slid(faster)
        if ratio >= declared - tolerance or math.isnan(ratio):
            break
    how = f"force ratio of a can that slides at {faster:g} m/s{where}, balanced on its rim"
    if not abs(ratio - declared) <= tolerance:
        # friction may be bounded by the load of the step before, which in a first step is another
        for way in ways:
            steady = _steady(stand, depths.tolist(), moving(speed * way))
            # the same as in a first step it is a wrong friction, and no other load's
            lags = abs(steady - ratio) > _STEADY * declared
            if lags and abs(steady - declared) <= _STEADY * declared:
                ratio, tolerance = steady, _STEADY * declared
                how = f"force ratio of a can that slides at {speed:g} m/s{where}, its load steady"
                break
    return quantity, "1", declared, ratio, tolerance, how


def _steady(stand: Stand, depths: list[float], twist: Twist) -> float:
    """Return the force ratio in the first step of a slide whose load is as in the step before.

    That one step decides: of many, in which a wrong friction changes, one may be right by chance.
    It is NaN if the load is never steady.
    """
    weight = stand.body.mass * stand.scene.gravity
    borne = (depth for depth in depths if stand.press(depth, twist).force[2] >= weight)
    forces = [each.force for each in islice(stand.pressed(next(borne, depths[-1]), twist), _SLIDE)]
    for before, after in pairwise(forces):
        if after[2] > 0.0 and abs(after[2] - before[2]) <= _STEADY * after[2]:
            return math.hypot(after[0], after[1]) / float(after[2])
    return math.nan


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
    depth = probed_depth(stand.scene, stiffness)
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


def probed_depth(scene: Scene, stiffness: float) -> float:
    """Return the depth at which a spring is probed, m: where it bears the weight.

    It needs a depth, gravity or not, at which the rim is in the plane and the can is not.
    """
    depth, radius = body(scene).mass * scene.gravity / stiffness, scene.can.radius
    return min(max(depth, 1e-9 * radius), 0.1 * radius)


def _resistance(stand: Stand, name: str, length: float, axis: Floats) -> Compared:
    """Read the arm of a moment that turning about an axis meets."""
    moments = np.linalg.eigvalsh(stand.body.inertia)
    stopped = length * stand.body.mass * max(stand.scene.gravity, 1.0) * stand.timestep
    spin = (1.0 + _SLOW * stopped / moments[0]) * axis
    arms = [
        ((abs(float(moment[2])) if axis is UP else math.hypot(moment[0], moment[1])) / load, load)
        for moment, load in stand.moments(spin)
    ]
    # pressed lightly, the friction that keeps a turning can on the spot has a large share of a cone
    # that the moment shares with it; pressed hard, a soft one holds back less than it may
    best, load = max(arms, default=(math.nan, math.nan))
    # a cone that is shared with sliding is short of what the spin slides within the step
    tolerance = length * (1e-3 + 50.0 * (stand.timestep / natural_time(stand.scene)) ** 2)
    # and a moment is a difference of angular momenta over the step, each known to some roundings
    rounding = _ROUNDINGS * stand.known.epsilon * moments[-1] * np.linalg.norm(spin)
    tolerance += float(rounding) / (stand.timestep * load)
    how = "moment over the normal force, in one step of turning on the spot, at the best load"
    return f"arm of {name}", "m", length, best, tolerance, how


def _impact(stand: Stand, coefficient: float) -> Compared:
    """Read what an impact gives back of the speed of the contact."""
    world, timestep = stand.world, stand.timestep
    world.place(lowered(stand.touching, -2.5 * _FALLING * timestep), moving(-_FALLING * UP))
    before = after = -_FALLING
    touched = False
    for _ in range(_FEW):
        world.step()
        twist = world.twist()
        after = float((twist.velocity + np.cross(twist.angular_velocity, stand.offset))[2])
        touched = touched or world.contact().force[2] > 0.0
        if not touched:
            before = after
        elif after >= 0.0:  # an engine that looks ahead first lets the rim come to the plane
            break
    # gravity acts in the step of the impact too
    tolerance = stand.known.solved + 2.0 * (stand.scene.gravity * timestep / _FALLING)
    how = f"an impact at {_FALLING:g} m/s, balanced on its rim"
    return "restitution", "1", coefficient, -after / before, tolerance, how
