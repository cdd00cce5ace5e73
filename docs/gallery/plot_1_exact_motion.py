"""
The exact motion
================

The paper's release, solved exactly: while the can is low, psi turns by more than half a circle in
some microseconds. :func:`harness.simulate` without an engine returns the exact motion.
"""

import matplotlib.pyplot as plt
import numpy as np

from harness import simulate

exact = simulate("paper-release")
(bounce,) = exact.bounces
print(f"the can is lowest at {bounce.time * 1e3:.3f} ms, at phi = {bounce.phi_min:.3e} rad")
print(f"angle of turn: {np.degrees(bounce.angle_of_turn):.4f} degrees")
print(f"largest precession rate: {bounce.peak_psi_dot / (2 * np.pi):.0f} turns a second")

# %%
# The samples of an exact motion lie dense by angle, so that the bounce is seen at any scale: on the
# left the whole motion, on the right ten microseconds of it.

motion = exact.motion
figure, rows = plt.subplots(2, 2, figsize=(9, 5), sharex="col", layout="constrained")
microseconds = (motion.time - bounce.time) * 1e6
near = np.abs(microseconds) < 100.0
for (whole, part), angle, name in zip(
    rows, (motion.angles.phi, motion.angles.psi), ("phi", "psi"), strict=True
):
    whole.plot(motion.time * 1e3, np.degrees(angle))
    part.plot(microseconds[near], np.degrees(angle[near]))
    whole.set_ylabel(f"{name} (degrees)")
rows[1][0].set_xlabel("time (ms)")
rows[1][1].set_xlabel("time from the bounce (microseconds)")
rows[1][1].set_xlim(-100, 100)
plt.show()
