"""What an engine says it honours, it must do: each effect by its law, and in the motion.

An engine that compiles worlds is probed for the law itself, as before every run; and wherever a
rigid can carries the effect, the motion must be the one that the exact equations give with it, and
not the one without.
"""

from dataclasses import replace

import numpy as np

from harness.engines.conformance.bench import FINE, Bench, BrokenContractError
from harness.engines.conformance.verdict import Found, not_applicable, within
from harness.engines.parity import parity
from harness.engines.probes.survey import opens_worlds
from harness.engines.reference import refusal, truth
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


def laws(bench: Bench) -> Found:
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


def motions(bench: Bench) -> Found:
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


def _honoured(bench: Bench) -> list[tuple[str, Scene]]:
    """Return each effect that the engine honours, and a scene that declares it."""
    return [
        (effect, replace(bench.gentle, effects=effects, horizon=Horizon(seconds=WATCHED)))
        for effect, effects in DECLARED.items()
        if effect in bench.engine.capabilities.honours
    ]


def _missed(bench: Bench, scene: Scene) -> float:
    """Return how far the motion is from the exact one, over how far the effect takes it."""
    path = bench.trajectory(bench.case(scene, FINE))
    exact = truth(scene).at(path.time)
    ideal = truth(replace(scene, effects=IDEAL)).at(path.time)
    taken = np.linalg.norm(exact.position - ideal.position, axis=1).max()
    if not taken > 0.0:
        raise BrokenContractError(f"the effects of {scene.effects.declared()} change nothing")
    return float(np.linalg.norm(path.position - exact.position, axis=1).max() / taken)
