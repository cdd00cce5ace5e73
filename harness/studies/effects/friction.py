"""The angle of turn against the coefficient of friction, with the phases of stick and slip.

From a frictionless plane to one that holds whatever rolling asks for: where the curves of all
engines meet the no-slip value, slip is no longer called for.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pandas as pd

from harness.core.case import Case
from harness.core.errors import UnsupportedEffectError
from harness.core.report_model import Column, Figure, Panel, Series, Table
from harness.core.trajectory import Floats
from harness.engines.ladder import takes_timestep
from harness.engines.registry import check_effects
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import QUANTITIES
from harness.studies.shared import run_columns
from models.contact_effects import Slip
from models.errors import ModelError
from models.scene import Scene

COEFFICIENTS = (0.0, 0.05, *(round(0.1 * n, 2) for n in range(1, 11)))
"""Of friction: ten of equal distance up to one, and one more where little friction does most."""

_SLIDES = 1e-6
"""Slip speed, over sqrt(g R), above which the rim of an exact motion slides: far above round-off,
far below any slip that moves the can."""

_COLUMNS = (
    run_columns.SCENE,
    run_columns.ENGINE,
    run_columns.MODEL,
    Column("mu", "Coefficient of friction."),
    Column("turn_deg", "First angle of turn, where the record can count it."),
    Column("slipping_share", "Share of the time in which the rim slides, by the motion itself."),
    Column("slip_phases", "Phases of slip; of the reference alone, whose contact has no creep."),
    run_columns.OUTCOME,
    run_columns.NOTE,
    run_columns.CASE,
)


FrictionLadder = Mapping[str, Mapping[float, Case]]
"""Runs of a scene that differ in friction alone, by engine and coefficient."""


def friction_ladder(
    scene: Scene, engines: tuple[str, ...], timestep: float | None
) -> FrictionLadder:
    """Return the ladder of friction for a scene, in each engine that can represent it."""
    ladder: dict[str, dict[float, Case]] = {name: {} for name in engines}
    for name, rungs in ladder.items():
        for mu in COEFFICIENTS:
            try:
                slippery = replace(scene, effects=replace(scene.effects, slip=Slip(mu=mu)))
                check_effects(name, slippery)
            except (ModelError, UnsupportedEffectError):
                continue
            step = timestep if name != "reference" and takes_timestep(name) else None
            rungs[mu] = Case(scene=slippery, engine=name, timestep=step)
    return ladder


def friction(
    scene: str, ladder: FrictionLadder, runs: Mapping[Case, Evaluation]
) -> tuple[Figure, Table]:
    """Return the figure of turn and phases against friction, and its table."""
    table = run_columns.scene_table(
        scene,
        "friction-runs",
        "Every run of the ladder of friction",
        _COLUMNS,
        _rows(ladder, runs),
        *("scene", "case"),
    )
    turns = tuple(
        Series(
            label=str(name),
            kind=str(name),
            x=own["mu"].to_numpy(dtype=np.float64),
            y=own["turn_deg"].to_numpy(dtype=np.float64),
            mark="both",
        )
        for name, own in table.frame.groupby("engine", sort=False)
    )
    figure = Figure(
        name=f"{scene}-friction",
        title="Turn against friction, and when the rim slides",
        seen=_seen(table.frame),
        panels=(
            Panel(
                title="First angle of turn",
                x_label="coefficient of friction mu []",
                y_label="angle of turn [deg]",
                series=turns,
            ),
            Panel(
                title="Phases of slip in the exact motion",
                x_label="time [s]",
                y_label="coefficient of friction mu []",
                series=_phases(ladder, runs),
            ),
        ),
        scene=scene,
    )
    return figure, table


def _sliding(e: Evaluation) -> tuple[Floats, np.ndarray[tuple[int], np.dtype[np.bool_]]]:
    """Return the instants of a motion and whether the rim slides there."""
    if e.motion is None:
        return np.empty(0), np.empty(0, dtype=np.bool_)
    scene = e.simulation.case.scene
    least = _SLIDES * math.sqrt(scene.gravity * scene.can.radius)
    return e.motion.time, np.nan_to_num(e.motion.slip) > least


def _phases(ladder: FrictionLadder, runs: Mapping[Case, Evaluation]) -> tuple[Series, ...]:
    """Return a line at each coefficient, drawn where the rim sticks and where it slides."""
    series = []
    for label, wanted, kind in (("slides", True, "truth"), ("sticks", False, "reference")):
        xs: list[Floats] = []
        ys: list[Floats] = []
        for mu, case in ladder.get("reference", {}).items():
            time, slides = _sliding(runs[case])
            xs += [time, np.array([np.nan])]
            ys += [np.where(slides == wanted, mu, np.nan), np.array([np.nan])]
        if xs:
            x, y = np.concatenate(xs), np.concatenate(ys)
            series.append(Series(label=label, kind=kind, x=x, y=y, dashed=not wanted))
    return tuple(series)


def _rows(ladder: FrictionLadder, runs: Mapping[Case, Evaluation]) -> list[dict[str, object]]:
    """Return every run in a row."""
    rows: list[dict[str, object]] = []
    for name, rungs in ladder.items():
        for mu, case in rungs.items():
            e = runs[case]
            row: dict[str, object] = {
                "simulation": e.simulation,
                "mu": mu,
                "turn_deg": QUANTITIES["turn_deg"].of_run(e),
            }
            time, slides = _sliding(e)
            if name == "reference" and len(time) > 1:
                row["slipping_share"] = float(np.sum(np.diff(time) * slides[1:]) / time[-1])
                row["slip_phases"] = int(np.sum(np.diff(slides.astype(int), prepend=0) > 0))
            rows.append(row)
    return rows


def _seen(frame: pd.DataFrame) -> str:
    """Return in two sentences from which friction on the rim holds, and how engines follow."""
    exact = frame[(frame["engine"] == "reference") & frame["slipping_share"].notna()]
    holds = exact[exact["slipping_share"] == 0.0]["mu"]
    first = (
        f"In the exact motion the rim never slides from mu = {holds.min():g} on. "
        if len(holds)
        else "The rim slides at every coefficient that was tried. "
    )
    if exact.empty:
        first = "The reference does not solve this scene with friction. "
    wide = frame.pivot_table(index="mu", columns="engine", values="turn_deg")
    differences = [
        f"{name} by at most {off.max():.2g} degrees"
        for name in wide.columns
        if name != "reference" and "reference" in wide
        if len(off := (wide[name] - wide["reference"]).abs().dropna())
    ]
    return first + (
        f"Engines differ from it: {', '.join(differences)}."
        if differences
        else "No engine has a turn to compare."
    )
