"""
The end of Euler's disk
=======================

A disk that spins down under one law of dissipation at a time: the nutation against the time that is
left until the steady law would end, which each law makes a straight line of its own slope. Below,
the disk is left behind by its own fall and tips onto the plane; only rolling resistance follows its
line to the end.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from harness.engines.reference.truth import truth
from models import load
from models.kinematics import nutation

LAWS = {
    "film": "film of air",
    "boundary-layer": "boundary layers of air",
    "contour-viscous": "viscous contour friction",
    "contour-dry": "dry contour friction",
    "rolling-resistance": "rolling resistance",
}
folder = next(
    place / "docs" / "theory" / "dissipation"
    for place in (Path.cwd(), *Path.cwd().parents)
    if (place / "docs" / "theory" / "dissipation").is_dir()
)

figure, axes = plt.subplots(figsize=(7.5, 4.6), layout="constrained")
for name, label in LAWS.items():
    motion = truth(load(folder / f"{name}.toml"))
    rest = motion.rest
    if rest is None:
        raise ValueError(f"{name} does not come to rest")
    end, p = float(rest["t_f_s"]), float(rest["exponent_predicted"])
    left = np.geomspace(end * 0.9999, end * 1e-5, 400)
    phi = nutation(motion.at(np.sort(end - left)).quaternion)[::-1]
    line = axes.loglog(np.sort(left), phi, label=f"{label}: p = {p:.3g}")[0]
    # of the slope of the law through the motion in its first half
    middle = phi[-60]
    start = np.sort(left)[-60]
    axes.loglog(left, middle * (left / start) ** p, ":", color=line.get_color(), linewidth=1.0)
    print(f"{label:26} p = {p:.4f}, fitted {rest['exponent']:.4f}; flat at {end:.6f} s")
axes.set_xlabel("time left until the disk lies flat (s)")
axes.set_ylabel("nutation (rad)")
axes.set_ylim(1e-6, 0.1)
axes.legend()
plt.show()
