"""What a case asks of an engine: settings and effects, refused, honoured or ended; and the contact.

An effect that an engine honours is probed by its law in the compiled world, as before every run;
where a rigid can carries the effect, the motion must be the one that the exact equations give with
the effect, and not the one without.

The contact must belong to the same instant as the state. Between samples t apart

    m (v' - v)/t = F - m g z

holds for the force F that was applied. A misfit as large as the change of F from sample to sample
is a force of the wrong instant; half of that is what a force at either end may differ from the
mean.
"""

import math
from dataclasses import fields, replace
from typing import Any

import numpy as np

from harness.core.errors import InvalidSettingError, UnknownSettingError, UnsupportedEffectError
from harness.core.simulation import Outcome, Simulation
from harness.engines.base import features_of
from harness.engines.conformance.suite import (
    FINE,
    BrokenContractError,
    ClauseResult,
    Fixture,
    clause,
    holds,
    not_applicable,
    within,
)
from harness.engines.parity.checks import parity
from harness.engines.reference.to_reference_problem import refusal
from harness.engines.reference.truth import truth
from harness.engines.registry import check_effects, names
from harness.engines.stepping.horizon import Watch
from models import IDEAL, KINDS, Effects, Horizon, Scene, contact_point
from models.kinematics import nutation

SLIPPERY = 0.05
"""Coefficient of friction below what the suite's release needs from the first instant on, 0.15."""

_CONSTANTS: dict[str, dict[str, float]] = {
    "slip": {"mu": SLIPPERY},
    "compliance": {"stiffness": 1e3, "damping": 5.0},
    "restitution": {"coefficient": 0.5},
    "drilling": {"length": 1e-3},
    "rolling_resistance": {"length": 1e-3},
    "contour_friction": {"coulomb": 0.05},
    "air_film": {"viscosity": 0.5},
    "damping": {"linear": 0.5, "angular": 0.5},
    "rim": {"radius": 1e-3},
    "tilt": {"angle": 0.05},
    "shake": {"frequency": 20.0, "vertical": 1e-4},
    "point_mass": {"mass": 4e-3, "x": 0.02},
}

DECLARED = {
    name: Effects(**{name: KINDS[name](**constants)}) for name, constants in _CONSTANTS.items()
}
"""A scene's effects with one of each kind, each strong enough to see in a tenth of a second."""

WATCHED = 0.1
"""s: before the bounce, where a small effect would be magnified, and an engine's error with it."""

MISSED = 0.1
"""Share of what an effect does that an engine may miss at a timestep of 1e-4. A law that is off by
a tenth costs as much; the first-order error of the engines costs 0.01 to 0.03."""

_DROPPED = 0.01
"""m: height of the release of the scene with restitution, which does nothing to a rolling rim."""

_ODD = (math.nan,) * 17
"""A value that no setting takes: seventeen numbers that are none."""


@clause("A setting that does not exist is refused by name.", needs_run=False)
def unknown_setting(fixture: Fixture) -> ClauseResult:
    """Ask for a setting that no engine has."""
    try:
        fixture.engine.simulate(fixture.case(no_such_setting=1.0))
    except UnknownSettingError as error:
        named = "no_such_setting" in str(error)
        return holds("" if named else f"the message does not name it: {error}", str(error))
    return holds("a setting that does not exist was taken", "")


@clause("A value of another kind than the setting's is refused.", needs_run=False)
def wrong_value(fixture: Fixture) -> ClauseResult:
    """Give every setting a value of another kind."""
    if not fixture.engine.settings:
        return not_applicable("the engine has no settings")
    taken = []
    for setting in fixture.engine.settings:
        odd: dict[str, Any] = {setting.name: _ODD}
        try:
            fixture.engine.simulate(fixture.case(**odd))
        except InvalidSettingError:
            continue
        taken.append(setting.name)
    wrong = f"took a value of another kind: {', '.join(taken)}" if taken else ""
    return holds(wrong, f"{len(fixture.engine.settings)} settings")


@clause("A scene that declares what the engine cannot represent is refused.", needs_run=False)
def unsupported_effect(fixture: Fixture) -> ClauseResult:
    """Declare every effect that the engine neither honours nor imposes."""
    capabilities = fixture.engine.capabilities
    represented = {*capabilities.honours, *capabilities.imposes}
    missing = [field.name for field in fields(Effects) if field.name not in represented]
    if not missing:
        return not_applicable("the engine honours or imposes every effect")
    if fixture.engine.name not in names():
        return not_applicable("the engine is not registered, so that no case reaches it")
    taken = []
    for effect in missing:
        try:
            check_effects(fixture.engine.name, replace(fixture.brief, effects=DECLARED[effect]))
        except UnsupportedEffectError:
            continue
        taken.append(effect)
    wrong = f"not refused: {', '.join(taken)}" if taken else ""
    return holds(wrong, f"refused: {', '.join(missing)}")


_UNTOLD = "the engine does not tell the force that moves the can"


def _tells_forces(fixture: Fixture) -> bool:
    return features_of(fixture.engine).description.tells_forces


@clause("Where slip is honoured, friction reaches what is declared and not more.", contact=True)
def friction(fixture: Fixture) -> ClauseResult:
    """Put the can on a slippery plane, if the engine says that it honours slip."""
    if "slip" not in fixture.engine.capabilities.honours:
        return not_applicable("the engine does not honour slip")
    if not _tells_forces(fixture):
        return not_applicable(_UNTOLD)
    scene = replace(fixture.brief, effects=DECLARED["slip"])
    force = fixture.trajectory(fixture.case(scene)).contact_force
    bears = force[:, 2] > 0.0
    if not bears.any():
        return holds("no sample bears a load", "")
    ratio = np.hypot(force[bears, 0], force[bears, 1]) / force[bears, 2]
    # the release needs three times this friction, so that the rim slips and takes all there is; an
    # engine that slips late or solves loosely may fall short, none may exceed it by a thousandth
    if not ratio.max() > SLIPPERY / 2.0:
        return holds(f"friction ratio of {ratio.max():.2g} where {SLIPPERY} is called for", "")
    over = float(ratio.max()) / SLIPPERY - 1.0
    return within(over, 1e-3, "relative", f"friction ratio beyond the declared {SLIPPERY}")


@clause("Each effect that is honoured follows its law in the compiled world.")
def laws_of_effects(fixture: Fixture) -> ClauseResult:
    """Probe each effect that the engine says it honours in the compiled world."""
    chosen, features = fixture.engine, features_of(fixture.engine)
    opens, said = features.open, features.description
    if opens is None:
        return not_applicable("the engine compiles no world that could be probed")
    honoured = _honoured(fixture)

    def differing(scene: Scene) -> set[tuple[str, float]]:
        """Return what differs in a scene, each with what the scene declares."""
        case = fixture.case(scene, FINE)
        world = opens(case)
        timestep = chosen.timestep(case) or world.timestep
        rows = parity(
            world,
            scene,
            timestep,
            {},
            fixture.precision(case),
            method=said.method,
            tells_forces=said.tells_forces,
        )
        return {(row.quantity, row.declared) for row in rows if row.verdict == "mismatch"}

    # what is known to differ, and does without an effect as well, is no law of it
    chosen_rows = features.imposed_in
    known = {} if chosen_rows is None else chosen_rows(fixture.case(fixture.brief, FINE))
    ideal = {(row, declared) for row, declared in differing(fixture.brief) if row in known}
    wrong = [
        f"{effect}: {quantity}"
        for effect, scene in honoured
        for quantity, _ in sorted(differing(scene) - ideal)
    ]
    detail = ", ".join(effect for effect, _ in honoured) or "none is honoured"
    return within(float(len(wrong)), 0.0, "quantities", "; ".join(wrong) or detail)


@clause("With an effect that is honoured the can moves as the exact equations say.")
def motion_with_effects(fixture: Fixture) -> ClauseResult:
    """Compare the motion with each effect with the exact motions with and without it."""
    worst, named = 0.0, []
    for effect, scene in _honoured(fixture):
        if refusal(scene):
            continue
        missed = _missed(fixture, scene)
        named.append(f"{effect} {missed:.2g}")
        worst = max(worst, missed)
    if not named:
        return not_applicable("the engine honours no effect whose exact motion is known")
    return within(worst, MISSED, "1", f"share of each effect that is missed: {', '.join(named)}")


def _honoured(fixture: Fixture) -> list[tuple[str, Scene]]:
    """Return each effect that the engine honours, and a scene that declares it."""
    released = replace(fixture.gentle, horizon=Horizon(seconds=WATCHED))
    dropped = replace(released, release=replace(released.release, height=_DROPPED))
    return [
        (effect, replace(dropped if effect == "restitution" else released, effects=effects))
        for effect, effects in DECLARED.items()
        if effect in fixture.engine.capabilities.honours
    ]


def _missed(fixture: Fixture, scene: Scene) -> float:
    """Return how far the motion is from the exact one, over how far the effect takes it."""
    path = fixture.trajectory(fixture.case(scene, FINE))
    exact = truth(scene).at(path.time)
    ideal = truth(replace(scene, effects=IDEAL)).at(path.time)
    taken = np.linalg.norm(exact.position - ideal.position, axis=1).max()
    if not taken > 0.0:
        raise BrokenContractError(f"the effects of {scene.effects.declared()} change nothing")
    return float(np.linalg.norm(path.position - exact.position, axis=1).max() / taken)


_VIOLENT = 1e8
"""rad/s: the can would turn a hundred thousand times in a timestep of the suite."""

_COARSEST = 0.5
"""s: a timestep of a whole rocking."""

_DEPTH, _SHORT = 1e-3, 5e-6
"""m and s: a penetration that is pushed out within some steps."""


@clause("What no engine can do ends with an outcome, not with an exception.", needs_run=False)
def divergence(fixture: Fixture) -> ClauseResult:
    """Ask for what few engines can do, and see that they say so.

    Violent rates; a timestep as long as the motion; and a rim that starts inside the plane, which a
    contact tied to a short timestep throws out at any speed.
    """
    if not fixture.steps:
        return not_applicable("a solver that chooses its own steps takes as many as it needs")
    release = fixture.brief.release
    violent = replace(release, phi_dot=_VIOLENT, theta_dot=_VIOLENT)
    sunk = replace(release, height=-_DEPTH)
    endings = []
    for scene, timestep in (
        (replace(fixture.brief, release=violent), 1e-3),
        (replace(fixture.gentle, horizon=Horizon(seconds=20.0)), _COARSEST),
        (replace(fixture.brief, release=sunk), _SHORT),
    ):
        # raises where the answer is no simulation
        simulation = fixture.run_anew(fixture.case(scene, timestep))
        outcome: object = simulation.outcome
        if not isinstance(outcome, Outcome):
            return holds(f"`outcome` is {outcome!r}, not an Outcome", "")
        if _exploded(simulation) and outcome is not Outcome.DIVERGED:
            return holds(f"the speed grows without bound, and the outcome is {outcome.name}", "")
        endings.append(simulation.outcome.name.lower().replace("_", " "))
    return holds("", ", ".join(endings))


def _exploded(simulation: Simulation) -> bool:
    """Whether the record reaches a speed that no fall gives."""
    path = simulation.trajectory
    if path is None:
        return False
    watch = Watch(simulation.case.scene)
    return watch.over(path.time, path.velocity, nutation(path.quaternion)) is Outcome.DIVERGED


@clause("Where nothing touches there is no contact point and no force.", contact=True)
def flight(fixture: Fixture) -> ClauseResult:
    """Throw the can up: where nothing touches there is no contact point, and no force."""
    if not fixture.steps and features_of(fixture.engine).open is None:
        return not_applicable("a can that rolls by its equations does not leave the plane")
    path = fixture.trajectory(fixture.case(fixture.thrown, FINE))
    pointed = np.isfinite(path.contact_point).all(axis=1)
    pushed = path.contact_force[:, 2] > 0.0
    wrong = []
    if (pointed != pushed).any():
        wrong.append(f"{int((pointed != pushed).sum())} samples with a point but no force, or not")
    if ((path.contact_count > 0) != pushed).any():
        wrong.append("the number of points that bear a force does not tell whether one does")
    if np.any(path.contact_force[~pushed] != 0.0):
        wrong.append("a force without a load")
    if pushed.all():
        wrong.append("the thrown can never leaves the plane")
    return holds("; ".join(wrong), f"{int((~pushed).sum())} of {len(path)} samples in flight")


NEWTON = 0.6
"""Misfit over the change of the force from sample to sample: 0 where a force is that of its step,
1/2 where that of its first instant is, with a tenth for the curvature; 1 is the next instant."""

SAME = 0.1
"""Distance of the contact point from the lowest point of the rim, over the way of that point from
sample to sample: 1 is the next instant. A tenth is left to engines that round the rim a little."""


@clause("The contact force is the one that changed the velocity.")
def newton(fixture: Fixture) -> ClauseResult:
    """Compare the force of each sample with the change of the velocity up to the next."""
    if not _tells_forces(fixture):
        return not_applicable(_UNTOLD)
    path = fixture.trajectory()
    can, gravity = fixture.brief.can, fixture.brief.gravity
    if len(path) < 3:  # noqa: PLR2004 - two changes of the velocity to compare one change of force
        return holds(f"{len(path)} samples are too few", "")
    gained = can.mass * np.diff(path.velocity, axis=0) / np.diff(path.time)[:, None]
    weight = np.array((0.0, 0.0, can.mass * gravity))
    misfit = np.linalg.norm(gained - path.contact_force[:-1] + weight, axis=1)
    change = np.linalg.norm(np.diff(path.contact_force, axis=0), axis=1)
    # root mean squares, so that one step in which the force happens to rest does not decide
    ratio = float(np.sqrt(np.mean(misfit**2) / np.mean(change**2)))
    worst = float(misfit.max()) / (can.mass * gravity)
    detail = f"misfit over the change of the force; at most {worst:.1g} of the weight"
    return within(ratio, NEWTON, "1", detail)


@clause("The contact point is the lowest point of the rim of the same state.")
def same_instant(fixture: Fixture) -> ClauseResult:
    """Compare the contact point of each sample with the lowest point of the rim."""
    path = fixture.trajectory(fixture.case(fixture.gentle, FINE))
    low = contact_point(fixture.gentle.can, path.position, path.quaternion)
    single = (path.contact_count == 1)[:-1]
    if not single.any():
        return holds("no sample touches in one point", "")
    off = np.linalg.norm((path.contact_point - low)[:-1, :2], axis=1)[single]
    way = np.linalg.norm(np.diff(low[:, :2], axis=0), axis=1)[single]
    ratio = float(np.sqrt(np.mean(off**2) / np.mean(way**2)))
    worst = float(off.max()) / fixture.gentle.can.radius
    detail = f"distance over the way between samples; at most {worst:.1g} of the radius"
    return within(ratio, SAME, "1", detail)
