"""Figures of gradients: the error against the step of a difference, and of an engine's own."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from harness.core.case import Case
from harness.core.report_model import Figure, Panel, Series
from harness.engines.ladder import rung_of, spelled
from harness.studies.gradients.derivatives import OWN_STEPS, PROGRAM
from harness.studies.gradients.design import instants, label_of
from harness.studies.gradients.findings import Differences, OwnDerivative


def steady(base: Case) -> bool:
    """Whether all steps of a case are alike, or chosen by the engine itself."""
    return base.profile != "adaptive"


def at_finest(differences: Sequence[Differences]) -> list[Differences]:
    """Return those at the finest timestep of each engine, and those of adaptive steps."""
    last = {(each.base.engine, each.base.profile): each.base for each in differences}
    return [each for each in differences if each.base in last.values()]


def case_name(base: Case) -> str:
    """Return an engine with its timestep or its accuracy."""
    if base.engine == "reference":
        return "exact motion"
    rung = rung_of(base)
    return f"{base.engine}, {base.profile if rung is None else spelled(base.engine, rung)}"


_DRAWN = ("angle_of_turn_deg", "period_s")
"""Quantities that figures show: the turn is the hardest, the period the easiest."""

_LEAST_ERROR = 1e-14
"""Smaller errors are drawn here."""


def step_figures(scene: str, differences: Sequence[Differences]) -> Iterator[Figure]:
    """Yield for each quantity that is drawn its error against the step, a panel a key."""
    drawn = [*_DRAWN, *(q for q in dict.fromkeys(d.quantity for d in differences) if "_at_" in q)]
    for quantity in drawn:
        own = [each for each in differences if each.quantity == quantity]
        keys = dict.fromkeys(each.key for each in own if each.values)
        if not any(each.exact for each in own):
            continue
        label = label_of(quantity)
        yield Figure(
            name=f"{scene}-steps-{quantity.replace('_', '-').replace('.', '-')}",
            title=f"{label}: error of a difference against its step",
            seen=(
                "To the right a difference is too long and its error falls as the square of the "
                "step; to the left it subtracts numbers that are alike, and noise grows as the "
                "step shrinks. Where a line is level between the two, the engine's own motion has "
                "another derivative than the exact one."
            ),
            panels=tuple(
                Panel(
                    title=f"{label} by {key}",
                    x_label="relative step",
                    y_label="relative error",
                    series=tuple(_step_series([each for each in own if each.key == key])),
                    log_x=True,
                    log_y=True,
                )
                for key in keys
            ),
            scene=scene,
        )


def _step_series(own: Sequence[Differences]) -> Iterator[Series]:
    """Yield a line for each engine and timestep, the coarse ones dashed."""
    finest = {each.base for each in at_finest(own)}
    for each in own:
        errors = [math.nan if e is None else max(e, _LEAST_ERROR) for e in each.errors.values()]
        yield Series(
            label=case_name(each.base),
            kind=each.base.engine,
            x=np.array(list(each.errors)),
            y=np.array(errors),
            mark="both",
            dashed=each.base not in finest,
        )


def instants_of(differences: Sequence[Differences]) -> dict[str, float]:
    """Return the instants at which phi is differentiated, s, by quantity."""
    return instants(differences[0].base.scene) if differences else {}


def instant_figures(scene: str, differences: Sequence[Differences]) -> Iterator[Figure]:
    """Yield how far along a motion differences are right, if phi is differentiated at instants.

    Each engine is at its finest timestep; a panel is the exact growth, or the error of one step.
    """
    times = instants_of(differences)
    if not times:
        return
    own = [each for each in at_finest(differences) if each.quantity in times]
    keys = dict.fromkeys(each.key for each in own)
    steps = list(own[0].values)[1::2]
    panels = [
        Panel(
            title="exact derivative of phi",
            x_label="time [s]",
            y_label="rad per relative change",
            series=tuple(
                Series(
                    label=f"exact, by {key}",
                    kind="reference",
                    x=np.array(list(times.values())),
                    y=np.array(
                        [
                            abs(next(e for e in own if (e.key, e.quantity) == (key, q)).growth)
                            for q in times
                        ]
                    ),
                    mark="both",
                )
                for key in keys
            ),
            log_y=True,
        )
    ]
    first = next(iter(keys))
    for base in dict.fromkeys(each.base for each in own):
        mine = [each for each in own if each.base == base and each.key == first]
        series = []
        for step in steps:
            y = [math.nan if (e := each.errors[step]) is None else e for each in mine]
            series.append(
                Series(
                    label=f"{case_name(base)}, step {step:.0e}",
                    kind=base.engine,
                    x=np.array([times[each.quantity] for each in mine]),
                    y=np.maximum(np.array(y), _LEAST_ERROR),
                    mark="both",
                )
            )
        panels.append(
            Panel(
                title=f"{case_name(base)}: by {first}",
                x_label="time [s]",
                y_label="relative error",
                series=tuple(series),
                log_y=True,
            )
        )
    yield Figure(
        name=f"{scene}-instants",
        title="Derivatives of phi along a motion",
        seen=(
            "The exact derivative of phi at a time grows exponentially where the motion is chaos. "
            "A difference leaves the linear range once its step times the derivative is a share of "
            "phi itself; an engine's own error grows like the derivative does."
        ),
        panels=tuple(panels),
        scene=scene,
    )


def own_figures(scene: str, own: Sequence[OwnDerivative]) -> Iterator[Figure]:
    """Yield the errors of the engines' own derivatives against their own step, if there are any."""
    judged = [each for each in own if each.error is not None]
    if not judged:
        return
    finest = {each.base.engine: each.base for each in judged}
    panels = []
    for quantity in dict.fromkeys(each.quantity for each in judged):
        series = []
        for engine, base in finest.items():
            mine = [e for e in judged if e.base is base and e.quantity == quantity]
            for key, settings in dict.fromkeys((each.key, each.settings) for each in mine):
                of_key = [e for e in mine if (e.key, e.settings) == (key, settings)]
                name = f"{engine}, {key.removeprefix('release.')}"  # a longer one does not fit
                series.append(_own_series(name, of_key))
        panels.append(
            Panel(
                title=label_of(quantity),
                x_label="step of the engine's own differences",
                y_label="relative error",
                series=tuple(series),
                log_x=True,
                log_y=True,
            )
        )
    yield Figure(
        name=f"{scene}-own-derivatives",
        title="Derivatives of the engines' own",
        seen=(
            "The engine differentiates each of its steps and the products are chained over the "
            "bounce. Its differences must be short beside the depth to which the contact gives "
            "way, or they leave the contact that they differentiate. An engine that differentiates "
            "its program takes no differences: its error is a level, dashed line."
        ),
        panels=tuple(panels),
        scene=scene,
    )


def _own_series(label: str, own: Sequence[OwnDerivative]) -> Series:
    """Return the errors of one derivative over the steps of differences, or the level without."""
    errors = np.array([max(each.error or 0.0, _LEAST_ERROR) for each in own])
    program = own[0].step == PROGRAM
    if program:
        x, y = np.array([min(OWN_STEPS), max(OWN_STEPS)]), np.repeat(errors[:1], 2)
    else:
        x, y = np.array([float(each.step) for each in own]), errors
    return Series(
        label=label,
        kind=own[0].base.engine,
        x=x,
        y=y,
        mark="line" if program else "both",
        dashed=program,
    )
