"""The capabilities study: cases of engines and profiles in, one table, one figure and words out."""

import numpy as np
import pytest

from harness.artefact import Artefact, Figure, Prose, Table
from harness.case import Case
from harness.engines.probes import Finding, Measurement, Trace
from harness.studies.capabilities import design, read
from harness.studies.capabilities.reading import imposed
from models import load


def finding(value: float, expected: float = 0.0, unit: str = "m") -> Finding:
    """Return a finding with a value."""
    return Finding(
        effect="compliance",
        quantity="static penetration under its weight",
        unit=unit,
        value=value,
        expected=expected,
        how="put there",
    )


def measurement(engine: str, profile: str, value: float) -> Measurement:
    """Return a measurement with one finding and one trace."""
    trace = Trace(
        effect="compliance",
        x_label="load [N]",
        y_label="depth [m]",
        x=np.array((1.0, 2.0)),
        y=np.array((value, 2.0 * value)),
    )
    return Measurement(
        case=Case(scene=load("gentle-rock"), engine=engine, profile=profile),
        engine_version="9",
        timestep=1e-3,
        findings=(finding(value),),
        traces=(trace,),
    )


@pytest.fixture
def artefacts() -> tuple[Artefact, ...]:
    """Return the artefacts of two engines, one of which imposes nothing."""
    return read([measurement("soft", "default", 1e-3), measurement("hard", "matched", 0.0)])


def test_each_engine_is_probed_as_it_ships_and_matched() -> None:
    cases = design(("mujoco", "pybullet"))
    assert [(case.engine, case.profile) for case in cases] == [
        ("mujoco", "default"),
        ("mujoco", "matched"),
        ("pybullet", "default"),
        ("pybullet", "matched"),
    ]
    assert {case.timestep for case in design(("mujoco",), timestep=1e-5)} == {1e-5}


def test_the_table_holds_every_finding(artefacts: tuple[Artefact, ...]) -> None:
    (table,) = [each for each in artefacts if isinstance(each, Table)]
    assert table.frame["value"].tolist() == [1e-3, 0.0]
    assert table.frame["engine"].tolist() == ["soft", "hard"]
    assert set(table.frame.columns) == set(table.columns)
    assert set(table.shown) <= set(table.columns)


def test_the_figure_has_a_panel_for_an_effect_and_a_curve_for_an_engine(
    artefacts: tuple[Artefact, ...],
) -> None:
    (figure,) = [each for each in artefacts if isinstance(each, Figure)]
    (panel,) = figure.panels
    assert [(series.kind, series.dashed) for series in panel.series] == [
        ("soft", True),
        ("hard", False),
    ]
    assert "imposed by soft, profile default" in figure.seen


def test_the_words_say_who_adds_what(artefacts: tuple[Artefact, ...]) -> None:
    (prose,) = [each for each in artefacts if isinstance(each, Prose)]
    assert "soft 9 as it ships, at a timestep of 0.001 s, adds: compliance." in prose.text
    assert "hard 9 matched, at a timestep of 0.001 s, adds: nothing that was probed." in prose.text
    assert "Its rim sinks 0.001 m" in prose.text


@pytest.mark.parametrize(
    ("found", "answer"),
    [
        (finding(0.0), False),
        (finding(1e-10), False),
        (finding(1e-8), True),
        (finding(float("nan")), True),
        (finding(100.0, 1e4, "m/s"), True),
        (finding(1e4, 1e4, "m/s"), False),
        (finding(1.0 + 1e-6, 1.0, "1"), False),
        (finding(1.0 + 1e-4, 1.0, "1"), True),
    ],
)
def test_what_counts_as_imposed(found: Finding, answer: bool) -> None:  # noqa: FBT001
    assert imposed(found) is answer
