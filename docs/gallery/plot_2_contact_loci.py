"""
Contact loci
============

The rim touches the table in one point, which draws a curve on the table: four scenes of the
catalogue, exactly.
"""

import matplotlib.pyplot as plt

from harness import load_scene, simulate

figure, places = plt.subplots(2, 2, figsize=(8, 8), layout="constrained")
for name, axes in zip(("paper-release", "petals", "cusps", "wobble"), places.flat, strict=True):
    exact = simulate(name)
    x, y = exact.motion.locus.T / load_scene(name).can.radius
    axes.plot(x, y, linewidth=1.2)
    axes.plot(x[0], y[0], "o", markersize=5)
    axes.set_title(name)
    axes.set_aspect("equal")
    axes.set_xlabel("x / R")
    axes.set_ylabel("y / R")
plt.show()

# %%
# The dot is the release. A bounce is an arc of the rim that the contact point runs along; between
# two bounces it hardly moves.
