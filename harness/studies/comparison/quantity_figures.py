"""The figure of one quantity of given runs: panels of the report's figures of their scene."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from harness.core.errors import HarnessError
from harness.core.report_model import Figure, Panel
from harness.evaluation.evaluation import Evaluation
from harness.studies.comparison.figures import scene_figures
from harness.studies.comparison.selection import by_case
from models.errors import did_you_mean

ANGLES = ("phi", "psi", "theta")
"""Each is a panel of two figures of the report: of the whole run, and of the first bounce."""

FIGURES = ("bounce", "angles", "locus", "friction", "residuals", "convergence")
"""Figures that the report has of a scene."""

QUANTITIES_DRAWN = (*ANGLES, *FIGURES)


class UnknownQuantityError(HarnessError, LookupError):
    """No figure shows a quantity of that name.

    Parameters
    ----------
    name : str
        What was asked for; there are `QUANTITIES_DRAWN`.
    """

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name

    def __str__(self) -> str:
        """List the quantities there are."""
        hint, names = did_you_mean(self.name, QUANTITIES_DRAWN), ", ".join(QUANTITIES_DRAWN)
        return f"no figure shows '{self.name}'{hint} there are: {names}"


class NotRunsError(HarnessError, TypeError):
    """What is to be drawn or shown is neither a run nor several.

    Parameters
    ----------
    kind : str
        Name of its type.
    """

    def __init__(self, kind: str) -> None:
        super().__init__(kind)
        self.kind = kind

    def __str__(self) -> str:
        """Say what is drawn, and how a part of a comparison is."""
        return (
            "runs are drawn: an Evaluation, a Comparison, or several Evaluations; this is of type "
            f"'{self.kind}'. Rows of a Comparison are drawn by: "
            "plot([comparison.evaluations[row] for row in rows.index])"
        )


@dataclass(eq=False, kw_only=True)
class NothingToDrawError(HarnessError, ValueError):
    """The runs have no figure of a quantity, or are not of one scene.

    Parameters
    ----------
    scenes : tuple of str
        Of the runs.
    quantity : str
        What was asked for; empty for whatever there is.
    drawn : tuple of str
        The quantities of which the runs have a figure.
    endings : tuple of str
        Of the runs without a motion.
    """

    scenes: tuple[str, ...]
    quantity: str = ""
    drawn: tuple[str, ...] = ()
    endings: tuple[str, ...] = ()

    def __str__(self) -> str:
        """Say what there is to draw, or why there is nothing."""
        if len(self.scenes) != 1:
            which = f"these are of {', '.join(self.scenes)}" if self.scenes else "there are none"
            return f"a figure is of runs of one scene; {which}"
        what = f" '{self.quantity}'" if self.quantity else ""
        have = f"they have: {', '.join(self.drawn)}" if self.drawn else "; ".join(self.endings)
        return f"the runs have no figure{what}; {have}"


def quantity_figure(evaluations: Sequence[Evaluation], quantity: str = "") -> Figure:
    """Return the report's figure of a quantity, with all of the runs given.

    Parameters
    ----------
    evaluations : sequence of Evaluation
        Of one scene.
    quantity : str
        One of `QUANTITIES_DRAWN`; the first figure that the report has of the scene if left out.

    Raises
    ------
    UnknownQuantityError
    NothingToDrawError
        If there are no runs, if they are of several scenes, or if none of them has the quantity.
    """
    if quantity and quantity not in QUANTITIES_DRAWN:
        raise UnknownQuantityError(quantity)
    scenes = [scene for (scene,) in by_case(evaluations, "scene")]
    if len(scenes) != 1:
        raise NothingToDrawError(scenes=tuple(scenes))
    figures = _figures(scenes[0], evaluations)
    chosen = quantity or next(iter(figures), "")
    if chosen in figures:
        return figures[chosen]
    endings = dict.fromkeys(e.simulation.ending for e in evaluations if e.motion is None)
    raise NothingToDrawError(
        scenes=tuple(scenes), quantity=chosen, drawn=tuple(figures), endings=tuple(endings)
    )


def _figures(scene: str, evaluations: Sequence[Evaluation]) -> dict[str, Figure]:
    """Return every figure in which something is drawn, by quantity."""
    runs = [e for e in evaluations if e.motion is not None]
    engines = [e for e in runs if e.simulation.case.engine != "reference"]
    drawn = scene_figures(scene, evaluations, engines or runs)
    if not engines:  # what a figure says is of engines
        drawn = tuple(replace(figure, seen="") for figure in drawn)
    own = {figure.name.removeprefix(f"{scene}-"): figure for figure in drawn}
    figures = {name: figure for name, figure in own.items() if any(map(_visible, figure.panels))}
    for angle in ANGLES:
        panels = [
            replace(panel, title=f"{panel.title}, {'whole run' if name == 'angles' else name}")
            for name in ("angles", "bounce")
            if name in figures
            for panel in figures[name].panels
            if panel.y_label.startswith(f"{angle} ")
        ]
        if panels:
            title = panels[0].title.partition(",")[0]
            figures[angle] = replace(
                figures["angles"],
                name=f"{scene}-{angle}",
                title=title,
                seen="",
                panels=tuple(panels),
                columns=len(panels),
            )
    return figures


def _visible(panel: Panel) -> bool:
    """Whether a curve of a panel has a point."""
    return bool(np.isfinite([*chain.from_iterable(series.y for series in panel.series)]).any())
