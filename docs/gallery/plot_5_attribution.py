"""
Who is to blame
===============

The gaps between MuJoCo as it ships and the exact motion, closed one after another on *gentle-rock*.
The command is ``rockingcan attribute gentle-rock --engine mujoco``.
"""

import matplotlib.pyplot as plt

from harness import load_scene, run_study
from harness.studies.attribution.study import AttributionStudy
from harness.studies.shared.ablation import ablation_path

path = ablation_path(load_scene("gentle-rock"), "mujoco", timestep=3e-4)
study = AttributionStudy(path=path)
attribution = study.findings(run_study(study))
turn = attribution.accounts["turn_error_deg"]

for sentence in attribution.sentences:
    print(sentence)

# %%
# Each bar is what closing a gap, after those to the left of it, takes away from the error of the
# turn. Bars of both signs cancel: an engine can look good for the wrong reasons.

figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
names = ["as it ships", *path.names, "remains"]
axes.bar(names, [turn.as_shipped, *turn.in_order, turn.remains])
axes.axhline(0.0, color="0.3", linewidth=0.8)
axes.set_ylabel("degrees of the turn")
axes.tick_params(axis="x", rotation=25)
plt.show()
