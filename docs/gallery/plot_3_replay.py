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
INSTANTS = np.linspace(0.0, 0.26, 6)  # s
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


figure, rows = plt.subplots(2, len(INSTANTS), figsize=(10, 5.2), sharey=True)
for (name, run), row in zip(runs.items(), rows, strict=True):
    track = run.motion.trajectory
    for instant, axes in zip(INSTANTS, row, strict=True):
        at = int(np.abs(track.time - instant).argmin())
        rims = [
            1e3 * np.array(side_view(track.quaternion[at], track.position[at], height))
            for height in (-half, half)
        ]
        for rim in rims:
            axes.plot(*rim, color="C0", linewidth=1.4)
        for side in (np.argmin, np.argmax):  # the walls, from rim to rim
            ends = [rim[:, side(rim[0])] for rim in rims]
            axes.plot(*np.transpose(ends), color="C0", linewidth=1.4)
        axes.axhline(0.0, color="0.4", linewidth=1.0)
        axes.set_aspect("equal")
        middle = 1e3 * track.position[at, 0]
        axes.set_xlim(middle - 62, middle + 62)
        axes.set_ylim(-10, 145)
        axes.set_title(f"{track.time[at] * 1e3:.0f} ms", fontsize=9)
        axes.set_xticks([])
    row[0].set_ylabel(f"{name}\nz (mm)")
figure.tight_layout()
plt.show()

# %%
# What the eye does not see, the numbers tell:

for name, run in runs.items():
    (bounce, *_) = run.bounces
    print(f"{name}: turned by {np.degrees(bounce.angle_of_turn):.2f} degrees")
