"""What an engine says it honours, it must do: each effect by its law, and in the motion.

An engine that compiles worlds is probed for the law itself, as before every run; and wherever a
rigid can carries the effect, the motion must be the one that the exact equations give with it, and
not the one without.

What an engine must refuse, and what it must honour because it says so.
"""

import math
from dataclasses import fields, replace
from typing import Any

import numpy as np

from harness.core.errors import InvalidSettingError, UnknownSettingError, UnsupportedEffectError
from harness.engines.conformance.fixture import (
    FINE,
    BrokenContractError,
    ClauseEvidence,
    Fixture,
    holds,
    not_applicable,
    within,
)
from harness.engines.parity.checks import parity
from harness.engines.probes.survey import opens_worlds
from harness.engines.reference.to_reference_problem import refusal
from harness.engines.reference.truth import truth
from harness.engines.registry import check_effects, names
from models.body_effects import Damping, PointMass, Shake, Tilt
from models.contact_effects import (
    Compliance,
    Drilling,
    Restitution,
    RollingResistance,
    RoundedRim,
    Slip,
)
from models.effects import IDEAL, Effects
from models.scene import Horizon, Scene

SLIPPERY = 0.05
"""Coefficient of friction below what the suite's release needs from the first instant on, 0.15."""

DECLARED = {
    "slip": Effects(slip=Slip(mu=SLIPPERY)),
    "compliance": Effects(compliance=Compliance(stiffness=1e4, damping=5.0)),
    "restitution": Effects(restitution=Restitution(coefficient=0.5)),
    "drilling": Effects(drilling=Drilling(length=1e-3)),
    "rolling_resistance": Effects(rolling_resistance=RollingResistance(length=1e-3)),
    "damping": Effects(damping=Damping(linear=0.5, angular=0.5)),
    "rim": Effects(rim=RoundedRim(radius=1e-3)),
    "tilt": Effects(tilt=Tilt(angle=0.05)),
    "shake": Effects(shake=Shake(frequency=20.0, vertical=1e-4)),
    "point_mass": Effects(point_mass=PointMass(mass=4e-3, x=0.02)),
}
"""A scene's effects with one of each kind, each strong enough to see in a tenth of a second."""

WATCHED = 0.1
"""s: before the bounce, where a small effect would be magnified, and an engine's error with it."""

MISSED = 0.1
"""Share of what an effect does that an engine may miss at a timestep of 1e-4. A law that is off by
a tenth costs as much; the first-order error of the engines costs 0.01 to 0.03."""


def laws(bench: Fixture) -> ClauseEvidence:
    """Probe each effect that the engine says it honours in the compiled world."""
    if not opens_worlds(bench.engine):
        return not_applicable("the engine compiles no world that could be probed")
    honoured = _honoured(bench)
    wrong = []
    for effect, scene in honoured:
        case = bench.case(scene, FINE)
        rows = parity(bench.engine.open(case), scene, bench.engine.timestep(case), frozenset())
        wrong += [f"{effect}: {row.quantity}" for row in rows if row.verdict != "equal"]
    detail = ", ".join(effect for effect, _ in honoured) or "none is honoured"
    return within(float(len(wrong)), 0.0, "quantities", "; ".join(wrong) or detail)


def motions(bench: Fixture) -> ClauseEvidence:
    """Compare the motion with each effect with the exact motions with and without it."""
    worst, named = 0.0, []
    for effect, scene in _honoured(bench):
        if refusal(scene):
            continue
        missed = _missed(bench, scene)
        named.append(f"{effect} {missed:.2g}")
        worst = max(worst, missed)
    if not named:
        return not_applicable("the engine honours no effect whose exact motion is known")
    return within(worst, MISSED, "1", f"share of each effect that is missed: {', '.join(named)}")


def _honoured(bench: Fixture) -> list[tuple[str, Scene]]:
    """Return each effect that the engine honours, and a scene that declares it."""
    return [
        (effect, replace(bench.gentle, effects=effects, horizon=Horizon(seconds=WATCHED)))
        for effect, effects in DECLARED.items()
        if effect in bench.engine.capabilities.honours
    ]


def _missed(bench: Fixture, scene: Scene) -> float:
    """Return how far the motion is from the exact one, over how far the effect takes it."""
    path = bench.trajectory(bench.case(scene, FINE))
    exact = truth(scene).at(path.time)
    ideal = truth(replace(scene, effects=IDEAL)).at(path.time)
    taken = np.linalg.norm(exact.position - ideal.position, axis=1).max()
    if not taken > 0.0:
        raise BrokenContractError(f"the effects of {scene.effects.declared()} change nothing")
    return float(np.linalg.norm(path.position - exact.position, axis=1).max() / taken)


_ODD = (math.nan,) * 17
"""A value that no setting takes: seventeen numbers that are none."""


def unknown_setting(bench: Fixture) -> ClauseEvidence:
    """Ask for a setting that no engine has."""
    case = bench.case(bench.brief, no_such_setting=1.0)
    try:
        bench.engine.simulate(case)
    except UnknownSettingError as error:
        named = "no_such_setting" in str(error)
        return holds("" if named else f"the message does not name it: {error}", str(error))
    return holds("a setting that does not exist was taken", "")


def wrong_value(bench: Fixture) -> ClauseEvidence:
    """Give every setting a value of another kind."""
    if not bench.engine.settings:
        return not_applicable("the engine has no settings")
    taken = []
    for setting in bench.engine.settings:
        odd: dict[str, Any] = {setting.name: _ODD}
        case = bench.case(bench.brief, **odd)
        try:
            bench.engine.simulate(case)
        except InvalidSettingError:
            continue
        taken.append(setting.name)
    wrong = f"took a value of another kind: {', '.join(taken)}" if taken else ""
    return holds(wrong, f"{len(bench.engine.settings)} settings")


def unsupported_effect(bench: Fixture) -> ClauseEvidence:
    """Declare every effect that the engine neither honours nor imposes."""
    own = bench.engine.capabilities
    missing = [
        field.name
        for field in fields(Effects)
        if field.name not in own.honours and field.name not in own.imposes
    ]
    if not missing:
        return not_applicable("the engine honours or imposes every effect")
    if bench.engine.name not in names():
        return not_applicable("the engine is not registered, so that no case reaches it")
    taken = []
    for effect in missing:
        try:
            check_effects(bench.engine.name, replace(bench.brief, effects=DECLARED[effect]))
        except UnsupportedEffectError:
            continue
        taken.append(effect)
    wrong = f"not refused: {', '.join(taken)}" if taken else ""
    return holds(wrong, f"refused: {', '.join(missing)}")


def friction(bench: Fixture) -> ClauseEvidence:
    """Put the can on a slippery plane, if the engine says that it honours slip."""
    if "slip" not in bench.engine.capabilities.honours:
        return not_applicable("the engine does not honour slip")
    scene = replace(bench.brief, effects=DECLARED["slip"])
    force = bench.trajectory(bench.case(scene)).contact_force
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
