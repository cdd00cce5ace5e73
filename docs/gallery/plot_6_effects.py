"""
Effects, one at a time
======================

What friction that lets go, resistance and damping do to the turn of *gentle-rock*: in the exact
motion and in MuJoCo, which gets what the scene declares and nothing else.
"""

import math
from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

from harness import load_scene, simulate
from models import Damping, Drilling, Effects, RollingResistance, Scene, Slip

ideal = load_scene("gentle-rock")
EFFECTS = {
    "slip, mu = 0.4": Effects(slip=Slip(mu=0.4)),
    "drilling, 30 um": Effects(drilling=Drilling(length=3e-5)),
    "rolling resistance, 30 um": Effects(rolling_resistance=RollingResistance(length=3e-5)),
    "damping": Effects(damping=Damping(linear=0.01, angular=0.01)),
}


def turn(scene: Scene, engine: str) -> float:
    """Return the angle of turn, degrees."""
    run = simulate(scene, engine, profile="matched" if engine == "reference" else "adaptive")
    return math.degrees(run.bounces[0].angle_of_turn)


changes = {}
for engine in ("reference", "mujoco"):
    without = turn(ideal, engine)
    changes[engine] = [
        turn(replace(ideal, effects=effects), engine) - without for effects in EFFECTS.values()
    ]
    for name, change in zip(EFFECTS, changes[engine], strict=True):
        print(f"{engine:9} {name:26} {change:+.4f} degrees")

# %%
# The effect with which a scene changes most is the first that a model of it needs.

figure, axes = plt.subplots(figsize=(8, 3.6), layout="constrained")
places = np.arange(len(EFFECTS))
for shift, (engine, own) in zip((0.2, -0.2), changes.items(), strict=True):
    axes.barh(places + shift, own, height=0.38, label={"reference": "exact"}.get(engine, "MuJoCo"))
axes.set_yticks(places, EFFECTS)
axes.axvline(0.0, color="0.3", linewidth=0.8)
axes.set_xlabel("change of the turn (degrees)")
axes.legend()
plt.show()
