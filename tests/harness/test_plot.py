"""What a notebook shows of results, and the figure of a quantity."""

import pickle
from typing import Any

import numpy as np
import pandas as pd
import pytest

from harness import Comparison, Evaluation, compare, plot, simulate
from harness.studies.comparison.quantity_figures import (
    QUANTITIES_DRAWN,
    NothingToDrawError,
    NotRunsError,
    UnknownQuantityError,
)


@pytest.fixture(scope="module")
def exact() -> Evaluation:
    return simulate("gentle-rock")


@pytest.fixture(scope="module")
def best() -> Evaluation:
    return simulate("gentle-rock", "mujoco", profile="adaptive")


@pytest.fixture(scope="module")
def comparison() -> Comparison:
    return compare("gentle-rock", ["mujoco"], timesteps=[1e-3, 5e-4])


def names(figure: object) -> list[str]:
    return [trace.name for trace in figure.data]  # type: ignore[attr-defined]


def test_an_angle_is_drawn_over_the_run_and_in_the_bounce(best: Evaluation) -> None:
    figure = plot(best, "phi")
    assert names(figure) == ["exact", "mujoco, adaptive"] * 2
    assert [trace.showlegend for trace in figure.data] == [True, True, False, False]
    motion = best.motion
    assert motion is not None
    assert np.array_equal(figure.data[1].y, np.degrees(motion.angles.phi))
    assert np.array_equal(figure.data[1].x, 1e3 * motion.time)
    assert [note.text for note in figure.layout.annotations] == [
        "Nutation phi, whole run",
        "Nutation phi, bounce",
    ]


@pytest.mark.parametrize("quantity", sorted(set(QUANTITIES_DRAWN) - {"convergence"}))
def test_every_quantity_of_a_run_is_drawn(best: Evaluation, quantity: str) -> None:
    assert "mujoco, adaptive" in names(plot(best, quantity))


def test_several_runs_are_drawn_each_once(exact: Evaluation, best: Evaluation) -> None:
    other = simulate("gentle-rock", "mujoco", timestep=1e-3, settings={"impratio": 10.0})
    assert set(names(plot([exact, best, other], "psi"))) == {
        "exact",
        "mujoco, adaptive",
        "mujoco, matched, 0.001 s, impratio=10.0",
    }


def test_every_run_of_a_comparison_is_drawn(comparison: Comparison) -> None:
    drawn = set(names(plot(comparison, "locus")))
    assert drawn == {"exact", "mujoco, default, 0.002 s"} | {
        f"mujoco, matched, {step} s" for step in ("0.001", "0.0005")
    }
    assert set(names(plot(comparison, "convergence"))) == {"mujoco, default", "mujoco, matched"}


def test_the_exact_motion_alone_is_drawn_once_and_compared_with_nobody(exact: Evaluation) -> None:
    assert set(names(plot(exact, "theta"))) == {"exact"}
    assert "Nearest" not in exact._repr_html_()


def test_a_plane_of_equal_axes_and_logarithms_are_those_of_the_report(best: Evaluation) -> None:
    assert plot(best, "locus").layout.yaxis.scaleanchor == "x"
    assert plot(best, "bounce").layout.yaxis.type == "log"


def not_drawn(runs: Evaluation | list[Evaluation], quantity: str) -> NothingToDrawError:
    with pytest.raises(NothingToDrawError) as caught:
        plot(runs, quantity)
    return caught.value


def test_a_quantity_that_no_figure_shows_is_refused(best: Evaluation) -> None:
    with pytest.raises(UnknownQuantityError) as caught:
        plot(best, "fhi")
    assert caught.value.name == "fhi"


def test_a_figure_that_the_runs_do_not_have_is_said_with_those_they_have(best: Evaluation) -> None:
    error = not_drawn(best, "convergence")
    assert (error.scenes, error.quantity) == (("gentle-rock",), "convergence")
    assert {"bounce", "angles"} < set(error.drawn) < set(QUANTITIES_DRAWN)
    assert not_drawn([], "phi").scenes == ()
    steady = simulate("steady-rolling", "mujoco", timestep=2e-3)
    assert not_drawn([best, steady], "phi").scenes == ("gentle-rock", "steady-rolling")
    assert plot(steady).layout.title.text == "The angles over the whole run"


def test_a_run_shows_its_numbers_and_the_exact_ones(best: Evaluation) -> None:
    html = best._repr_html_()
    assert html.count("<img ") == 1
    assert f'title="{best.bounces[0].time!r}"' in html
    assert f'title="{best.true_bounces[0].time!r}"' in html


def test_a_comparison_is_a_table_whose_parts_are_plain(comparison: Comparison) -> None:
    assert isinstance(comparison, pd.DataFrame)
    assert len(comparison) == len(comparison.evaluations)
    part = comparison[["engine", "timestep_s"]]
    assert type(part) is pd.DataFrame
    assert type(comparison[comparison.timestep_s < 1e-3]) is pd.DataFrame
    again = pickle.loads(pickle.dumps(comparison))  # noqa: S301 - just made
    assert type(again) is Comparison
    assert [e.simulation.digest for e in again.evaluations] == list(comparison["digest"])


def test_a_comparison_shows_itself_as_it_is(comparison: Comparison) -> None:
    changed = pickle.loads(pickle.dumps(comparison))  # noqa: S301 - just made
    changed["mine"] = 4711
    html = changed._repr_html_()
    assert html.count("<img ") == 1
    assert html.count("<td>4711</td>") == len(changed)
    assert "mine" not in (comparison._repr_html_() or "")
    with pd.option_context("display.notebook_repr_html", False):  # noqa: FBT003 - pandas has it so
        assert changed._repr_html_() is None


def test_rows_of_a_comparison_are_drawn_as_the_message_says(comparison: Comparison) -> None:
    rows = comparison[comparison.timestep_s == 5e-4]
    for part in (rows, comparison[["engine"]]):
        with pytest.raises(NotRunsError, match=r"comparison.evaluations\[row\]") as caught:
            plot(part, "phi")
        assert caught.value.kind == "DataFrame"
    chosen = [comparison.evaluations[row] for row in rows.index]
    assert set(names(plot(chosen, "phi"))) == {"exact", "mujoco, matched, 0.0005 s"}


@pytest.mark.parametrize("what", [5, None, "gentle-rock", ["gentle-rock"]])
def test_what_is_no_run_is_refused(what: Any) -> None:
    with pytest.raises(NotRunsError) as caught:
        plot(what)
    assert caught.value.kind == type(what).__name__
