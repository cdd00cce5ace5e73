"""From what was measured to artefacts: words, figures, prices, and everything behind them."""

from harness.artefact import Artefact, Prose
from harness.studies.cost.contract import contract
from harness.studies.cost.figures import hardness_figure, work_precision
from harness.studies.cost.hard_tables import growth, hardness
from harness.studies.cost.plateaus import falls
from harness.studies.cost.results import Cost
from harness.studies.cost.tables import orders, overhead, points, prices
from harness.studies.cost.words import all_pasted, summary

_FALLING = ("turn_deg", "phi_rms_rad", "bounce_time_s")
"""Errors whose order is read: one of the bounce, one of the whole, one of the time."""

_FALLING_WITHOUT = ("rotation_rms_deg", "phi_rms_rad")
"""The same for a scene that has no bounce."""


def read(cost: Cost) -> tuple[Artefact, ...]:
    """Return the artefacts of the study; no price without the contract and the overhead."""
    name = cost.plan.scene.name
    falling = _FALLING if cost.plan.target in _FALLING else _FALLING_WITHOUT
    hard = hardness_figure(cost)
    artefacts: list[Artefact] = [
        Prose(name="summary", title="Summary", text=summary(cost)),
        work_precision(cost),
        contract(cost),
        prices(cost),
        overhead(cost),
        Prose(
            name=f"{name}-paste",
            title="The tuned settings, to paste",
            text=all_pasted(cost) or "No engine reaches a target.",
            scene=name,
        ),
        orders(cost, falls(cost, falling)),
    ]
    if hard is not None:
        artefacts += [hard, hardness(cost), growth(cost)]
    artefacts.append(points(cost))
    return tuple(artefacts)
