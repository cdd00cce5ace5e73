"""
A sweep, as a map
=================

How far a can turns, over 101 x 101 releases: the exact bounce of each. What the command
``rockingcan sweep`` does in partitions is done here in one: a plan is made, and its rows computed.
"""

import matplotlib.pyplot as plt
import numpy as np

from harness import load_scene
from harness.sweep.axes import read_axis
from harness.sweep.partition import compute
from harness.sweep.plan import plan_sweep

SIDE = 101
axes = [read_axis(f"release.{name}=-1:1:{SIDE}") for name in ("psi_dot", "theta_dot")]
plan = plan_sweep(load_scene("paper-release"), axes, quantities=["angle_of_turn_deg"])
frame = compute(plan, range(plan.rows))
turn = frame["angle_of_turn_deg"].to_numpy().reshape(SIDE, SIDE)

figure, place = plt.subplots(figsize=(6.4, 5.2), layout="constrained")
ends = np.linspace(-1.0, 1.0, SIDE)
image = place.pcolormesh(ends, ends, turn, cmap="PuOr_r", vmin=-400, vmax=400)
place.set_xlabel("theta' at the release (rad/s)")
place.set_ylabel("psi' at the release (rad/s)")
figure.colorbar(image, label="angle of turn (degrees)")
plt.show()
