"""
Restitution asked for, and what engines give back
=================================================

The can is dropped on its rim at three speeds, and once while it slides six times as fast as it
falls. Each point is the rebound that an engine gives back at a timestep of 0.1 ms for the
coefficient that the scene declares, the worst of several tilts and distances; on the line they are
equal.
"""

import json
import re
from pathlib import Path

import matplotlib.pyplot as plt

ENGINES = {"mujoco": "MuJoCo", "pybullet": "PyBullet"}
REBOUND = re.compile(r"rebound of a declared ([\d.]+)(?: at ([\d.]+) sqrt\(g R\)|, (.*))")
MARKERS = {"0.02 sqrt(g R)": "v", "0.2 sqrt(g R)": "s", "2 sqrt(g R)": "o"}
folder = next(
    place / "reports" / "baseline"
    for place in (Path.cwd(), *Path.cwd().parents)
    if (place / "reports" / "baseline").is_dir()
)

figure, axes = plt.subplots(1, 2, figsize=(8.4, 4.2), layout="constrained", sharey=True)
for (engine, label), panel in zip(ENGINES.items(), axes, strict=True):
    printed = json.loads((folder / f"restitution-{engine}" / "printed.json").read_text())
    rebounds: dict[str, list[tuple[float, float]]] = {}
    for finding in printed["findings"]:
        told = REBOUND.fullmatch(finding["quantity"])
        if told is not None:
            how = f"{told[2]} sqrt(g R)" if told[2] else str(told[3])
            rebounds.setdefault(how, []).append((finding["expected"], finding["value"]))
    panel.plot([0, 1], [0, 1], color="0.6", linewidth=1.0)
    for how, points in rebounds.items():
        asked, measured = zip(*points, strict=True)
        panel.plot(
            asked, measured, MARKERS.get(how, "x"), label=how, markersize=5, fillstyle="none"
        )
        worst = max(abs(e - v) for e, v in points)
        print(f"{label:9} {how:18} largest miss {worst:.4f}")
    panel.set_title(f"{label}, timestep {printed['timestep_s']:g} s")
    panel.set_xlabel("coefficient asked for")
axes[0].set_ylabel("rebound measured")
axes[0].legend(title="speed of approach")
plt.show()
