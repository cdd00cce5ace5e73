"""From measurements to artefacts: what each engine imposes, in words, figures and a table."""

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from harness.artefact import Artefact, Figure, Panel, Prose, Series, Table
from harness.engines.probes import Finding, Measurement, Trace

_COLUMNS = {
    "engine": "Name of the engine.",
    "engine_version": "Version of the engine.",
    "profile": "default: the engine as it ships; matched: only what the scene declares.",
    "timestep_s": "Timestep of the engine, s.",
    "effect": "What the engine adds of its own accord.",
    "quantity": "What was measured of it.",
    "value": "What was found.",
    "expected": "What the ideal can has, or the closed form.",
    "unit": "Unit of both.",
    "how": "How it was probed.",
}

_NEGLIGIBLE, _NEGLIGIBLE_SHARE = 1e-9, 1e-5
"""Departures in which nothing is imposed: a nanometre, a nanometre a second; of numbers without a
unit more, since the error of the first order of a step of 1e-4 s shows in them."""

_LOGARITHMIC = {"contact points"}
"""Effects whose x spans decades."""


def read(measurements: Sequence[Measurement]) -> tuple[Artefact, ...]:
    """Return the artefacts of the study."""
    return (_words(measurements), *_figures(measurements), _table(measurements))


def imposed(finding: Finding) -> bool:
    """Whether a finding departs from the ideal can by more than a negligible amount."""
    if not math.isfinite(finding.value):
        return True
    scale = abs(finding.expected) or 1.0
    allowed = _NEGLIGIBLE_SHARE if finding.unit == "1" else _NEGLIGIBLE
    return abs(finding.value - finding.expected) > allowed * scale


def _table(measurements: Sequence[Measurement]) -> Table:
    """Return every finding of every engine."""
    rows = [
        {
            "engine": m.case.engine,
            "engine_version": m.engine_version,
            "profile": m.case.profile,
            "timestep_s": m.timestep,
            **{name: getattr(finding, name) for name in finding.__slots__},
        }
        for m in measurements
        for finding in m.findings
    ]
    return Table(
        name="capabilities",
        title="What each engine adds of its own accord",
        frame=pd.DataFrame(rows, columns=list(_COLUMNS)),
        columns=_COLUMNS,
        shown=(
            "engine",
            "profile",
            "timestep_s",
            "effect",
            "quantity",
            "value",
            "expected",
            "unit",
        ),
    )


def _figures(measurements: Sequence[Measurement]) -> tuple[Figure, ...]:
    """Return the curves of all effects, an effect a panel, an engine a colour."""
    effects: dict[str, list[tuple[Measurement, Trace]]] = {}
    for m in measurements:
        for trace in m.traces:
            effects.setdefault(trace.effect, []).append((m, trace))
    if not effects:
        return ()
    panels = tuple(
        Panel(
            title=effect.capitalize(),
            x_label=curves[0][1].x_label,
            y_label=curves[0][1].y_label,
            series=tuple(
                Series(
                    label=f"{m.case.engine}, {m.case.profile}",
                    kind=m.case.engine,
                    x=np.asarray(trace.x),
                    y=np.asarray(trace.y),
                    dashed=m.case.profile == "default",
                )
                for m, trace in curves
            ),
            log_x=effect in _LOGARITHMIC,
        )
        for effect, curves in effects.items()
    )
    return (
        Figure(
            name="capabilities",
            title="What each engine adds of its own accord",
            seen=(
                "Each panel isolates one effect; the ideal can is a line at zero, but for the turn "
                f"of a step, where it is the diagonal. {_most(measurements)}"
            ),
            panels=panels,
            columns=3,
        ),
    )


def _words(measurements: Sequence[Measurement]) -> Prose:
    """Return a sentence for each engine and profile."""
    sentences = []
    for m in measurements:
        found = list(dict.fromkeys(f.effect for f in m.findings if imposed(f)))
        words = "as it ships" if m.case.profile == "default" else m.case.profile
        told = ", ".join(found) if found else "nothing that was probed"
        sentences.append(
            f"{m.case.engine} {m.engine_version} {words}, at a timestep of {m.timestep:.3g} s, "
            f"adds: {told}. {_depth(m)}"
        )
    return Prose(
        name="capabilities-summary",
        title="What each engine adds",
        text=" ".join(sentences),
    )


def _depth(m: Measurement) -> str:
    """Return a sentence with the numbers that say most of a contact."""
    told = {
        "static penetration under its weight": "its rim sinks {:.2g} m under the can's weight",
        "creep of the rim": "creeps at {:.2g} m/s where friction should hold it",
        "energy gained": "and a spinning can gains {:.2g} of its energy in free flight",
    }
    values = {f.quantity: f.value for f in m.findings}
    parts = [words.format(values[key]) for key, words in told.items() if key in values]
    text = ", ".join(parts)
    return f"{text[:1].upper()}{text[1:]}." if text else ""


def _most(measurements: Sequence[Measurement]) -> str:
    """Return which engine and profile imposes the most effects."""

    def count(m: Measurement) -> int:
        return len({f.effect for f in m.findings if imposed(f)})

    most = max(measurements, key=count)
    return f"Most effects are imposed by {most.case.engine}, profile {most.case.profile}."
