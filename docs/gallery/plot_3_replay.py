"""
Replay
======

The can of *gentle-rock* through its bounce, exactly and in MuJoCo as it ships: poses at the same
instants, drawn from the side. The page that ``rockingcan validate`` writes plays them as a film.
"""

import matplotlib.pyplot as plt
import numpy as np

from harness import load_scene, simulate
from models import to_body

scene = load_scene("gentle-rock")
runs = {
    "exact": simulate(scene),
    "MuJoCo as it ships": simulate(scene, "mujoco", profile="default"),
}
INSTANTS = np.linspace(0.0, 0.26, 7)  # s
around = np.linspace(0.0, 2.0 * np.pi, 60)
circle = scene.can.radius * np.stack([np.cos(around), np.sin(around), 0.0 * around])
half = scene.can.half_height


def side_view(
    quaternion: np.ndarray, position: np.ndarray, height: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the outline of a rim in the plane of the picture, x and z in m."""
    axes = to_body(quaternion, np.eye(3))  # rows: the world's axes in the body
    rim = position[:, None] + axes @ (circle + np.array([[0.0], [0.0], [height]]))
    return rim[0], rim[2]


figure, rows = plt.subplots(2, len(INSTANTS), figsize=(11, 4.6), sharey=True, layout="constrained")
for (name, run), row in zip(runs.items(), rows, strict=True):
    track = run.motion.trajectory
    for instant, axes in zip(INSTANTS, row, strict=True):
        at = int(np.abs(track.time - instant).argmin())
        for height in (-half, half):
            x, z = side_view(track.quaternion[at], track.position[at], height)
            axes.plot(x * 1e3, z * 1e3, linewidth=1.2)
        axes.axhline(0.0, color="0.5", linewidth=0.8)
        axes.set_aspect("equal")
        axes.set_xlim(-75, 75)
        axes.set_title(f"{track.time[at] * 1e3:.0f} ms", fontsize=9)
        axes.set_xticks([])
    row[0].set_ylabel(f"{name}\nz (mm)")
plt.show()

# %%
# What the eye does not see, the numbers tell:

for name, run in runs.items():
    (bounce, *_) = run.bounces
    print(f"{name}: turned by {np.degrees(bounce.angle_of_turn):.2f} degrees")
