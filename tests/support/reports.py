"""Reports: a small one with everything in it, its texts as given, and one of real runs."""

from collections.abc import Callable
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pandas as pd

from harness.core.case import Case
from harness.core.provenance import Commit, Provenance
from harness.core.report_model import Artefact, Figure, Panel, Prose, Series, Table
from harness.core.verdict import Status, Verdict
from harness.evaluation.run_cases import run_cases
from harness.report.write import write_report
from harness.studies.comparison.study import comparison_report
from models import load

Words = Callable[[str], str]
"""Makes each text of a report."""

HOSTILE = "</script><script>document.title='owned'</script><img src=x onerror=owned()>&\"'$_{%|`"

CASES = (
    {
        "digest": "0123456789abcdef",
        "label": "gentle-rock mujoco matched dt=1e-05",
        "command": "rockingcan run gentle-rock --engine mujoco --timestep 1e-05",
    },
    {
        "digest": "fedcba9876543210",
        "label": "gentle-rock pybullet matched dt=1e-05",
        "command": "rockingcan run gentle-rock --engine pybullet --timestep 1e-05",
    },
)


def angles(words: Words) -> Figure:
    """Return two panels over the same times and a third over others."""
    time = np.linspace(0.0, 0.2, 500)
    phi = np.abs(0.4 * np.cos(21.0 * time)) + 0.003

    def series(shift: float) -> tuple[Series, ...]:
        return (
            Series(label=words("reference"), kind=words("reference"), x=time, y=phi),
            Series(
                label=words("MuJoCo, as shipped"),
                kind=words("mujoco"),
                x=time,
                y=phi + shift,
                dashed=True,
            ),
            Series(label=words("PyBullet"), kind=words("pybullet"), x=time, y=phi - shift),
        )

    late = tuple(
        Series(label=s.label, kind=s.kind, x=1e3 * (s.x[200:300] - 0.1), y=s.y[200:300])
        for s in series(0.002)
    )
    return Figure(
        name=words("angles"),
        title=words("Angles through the bounce"),
        seen=words("The can falls and rises. Both engines are late."),
        scene=words("gentle-rock"),
        panels=(
            Panel(
                title=words("Nutation"),
                x_label=words("time (s)"),
                y_label=words("φ (rad)"),
                series=series(0.01),
            ),
            Panel(
                title=words("Precession"),
                x_label=words("time (s)"),
                y_label=words("ψ (rad)"),
                series=series(0.02),
            ),
            Panel(
                title=words("Near the bounce"),
                x_label=words("time (ms)"),
                y_label=words("φ (rad)"),
                series=late,
            ),
        ),
    )


def order(words: Words) -> Figure:
    """Return points on logarithmic axes, of a kind without a name of its own, with hover texts."""
    step = np.array([1e-3, 1e-4, 1e-5, 1e-6])
    return Figure(
        name=words("order"),
        title=words("Error against timestep"),
        seen=words("The error falls with the timestep. It is of first order."),
        columns=1,
        panels=(
            Panel(
                title=words("Convergence"),
                x_label=words("timestep (s)"),
                y_label=words("error (°)"),
                log_x=True,
                log_y=True,
                series=(
                    Series(
                        label=words("a further engine"),
                        kind=words("further"),
                        x=step,
                        y=1e3 * step,
                        mark="both",
                        hover=tuple(words(f"run {n}") for n in range(len(step))),
                    ),
                ),
            ),
        ),
    )


def locus(words: Words) -> Figure:
    """Return a closed curve in the plane."""
    turn = np.linspace(0.0, 2.0 * np.pi, 300)
    curve = Series(
        label=words("reference"), kind=words("reference"), x=np.cos(turn), y=np.sin(turn)
    )
    return Figure(
        name=words("locus"),
        title=words("Contact locus"),
        seen=words("The contact point runs round a circle. It closes."),
        scene=words("gentle-rock"),
        panels=(
            Panel(
                title=words("From above"),
                x_label=words("x (m)"),
                y_label=words("y (m)"),
                series=(curve,),
                equal=True,
            ),
        ),
    )


def scorecard(words: Words) -> Table:
    """Return a table with numbers, a hole, a verdict and links to cases."""
    frame = pd.DataFrame(
        {
            "engine": [words("mujoco"), words("pybullet"), words("late")],
            "angle_of_turn_error_deg": [-0.1304, 0.0019, np.nan],
            "steps": [20_000, 4_000, 123_456],
            "verdict": [
                Verdict(Status.AGREES, words("agrees")),
                Verdict(Status.DEVIATES, words("deviates by a factor 3")),
                Verdict(Status.FAILED, words("failed")),
            ],
            "case": ["0123456789abcdef", "fedcba9876543210", words("none")],
        }
    )
    told = {str(name): words(f"What {name} means.") for name in frame.columns}
    return Table(name=words("scorecard"), title=words("Scorecard"), frame=frame, columns=told)


def everything(words: Words) -> tuple[Artefact, ...]:
    """Return artefacts of all kinds; `words` makes each of their texts."""
    parity = pd.DataFrame({"quantity": [words("mass")], "found_kg": [0.043]})
    return (
        Prose(
            name="summary",
            title=words("Summary"),
            text=words("Both engines agree.") + "\n\n" + words("The gap is of first order."),
        ),
        scorecard(words),
        angles(words),
        locus(words),
        Table(
            name=words("parity"),
            title=words("Model parity"),
            frame=parity,
            columns={"quantity": words("What was probed."), "found_kg": words("What was found.")},
            scene=words("gentle-rock"),
        ),
        Prose(
            name=words("why"),
            title=words("Why"),
            text=words("It is late."),
            scene=words("gentle-rock"),
        ),
        order(words),
    )


def provenance() -> Provenance:
    """Return where a report was made, as another machine would tell it."""
    return Provenance(
        rockingcan="0.1.0",
        python="3.11.7",
        packages=MappingProxyType({"mujoco": "4.0.0", "numpy": "2.4.0"}),
        platform="Linux",
        processor="a processor",
        cores=2,
        commit=Commit(digest="0" * 40, changed=True),
        written="2025-01-01T00:00:00+00:00",
    )


def hostile_words(text: str) -> str:
    """Return a text that tries to break out."""
    return f"{text} {HOSTILE}"


def write_small_report(out: Path, words: Words = str) -> Path:
    """Write a report of every kind of artefact, and return its folder."""
    cases = [{key: words(value) for key, value in case.items()} for case in CASES]
    write_report(
        everything(words), out, title=words("Two engines"), cases=cases, provenance=provenance()
    )
    return out


def write_real_report(out: Path) -> Path:
    """Write a report of both engines on one scene as `validate` does, and return its folder."""
    scene = load("gentle-rock")
    cases = [
        Case(scene=scene, engine=engine, profile=profile, timestep=step)
        for engine in ("mujoco", "pybullet")
        for profile, step in (("default", None), ("adaptive", None), ("matched", 1e-3))
    ]
    evaluations = run_cases(cases)
    told = [
        {
            "digest": e.simulation.case.digest(e.simulation.engine_version),
            "label": e.simulation.case.label(),
            "command": e.simulation.case.command(),
        }
        for e in evaluations
    ]
    write_report(
        comparison_report(evaluations),
        out,
        title="Two engines",
        cases=told,
        provenance=provenance(),
    )
    return out
