"""The study on a toy of known order, plateau and cost: it finds all three."""

import math
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from harness.core.case import Case, Value
from harness.core.report_model import Figure, Prose, Table
from harness.core.simulation import Outcome, Simulation
from harness.engines import registry
from harness.engines.base import Capabilities, Setting, Variant, resolve
from harness.engines.reference.truth import sample_truth, truth
from harness.evaluation import timing
from harness.execution.cache import CacheFolder
from harness.execution.isolated_pool import SerialExecutor
from harness.studies.cost.design import plan_cost
from harness.studies.cost.prices import FIXED, HERE, Cost
from harness.studies.cost.study import CostStudy, cost_report
from harness.studies.cost.tables import orders, points, price_rows
from harness.studies.study import run_study
from models import Scene, load
from tests.support.figures import assert_two_sentences

COARSE = 1e-3
"""s: the coarsest timestep of the gentle release."""

OFF = 1e-3
"""Relative error of psi' at release at the coarsest step: some hundredths of a degree of turn."""


def _setting(name: str, value: Value) -> Setting:
    return Setting(name=name, default=value, matched=value, meaning="As its name says.")


def departure(timestep: float, order: float, level: float) -> float:
    """Return by how much psi' of the toy is off, relatively."""
    return float(OFF * ((timestep / COARSE) ** order + level))


class Toy:
    """Moves the can exactly, from a release that is off by a power of the timestep and a level."""

    name = "toy"
    version = "1"
    settings = (
        _setting("order", 1.0),
        _setting("level", 0.0),
        _setting("price", 1e-6),
        _setting("breaks", 0),
    )
    variants = (
        Variant(name="first order"),
        Variant(name="second order", settings=(("order", 2.0), ("price", 2.5e-6))),
        Variant(name="levelled", settings=(("level", 0.1),), imposes="a level of its own"),
        Variant(name="dear", settings=(("price", 1e-4),)),
        Variant(name="twin", settings=(("price", 1.05e-6),)),
        Variant(name="broken", settings=(("breaks", 1),)),
    )
    capabilities = Capabilities(honours=frozenset(), imposes={})

    def timestep(self, case: Case) -> float:
        """Return the timestep, s."""
        return case.timestep or COARSE

    def simulate(self, case: Case) -> Simulation:
        """Solve the scene exactly with psi' off; claim a cost of `price` a step."""
        timestep = self.timestep(case)
        chosen = resolve(case, self.settings, timestep)
        off = departure(timestep, float(chosen["order"]), float(chosen["level"]))  # type: ignore[arg-type]
        release = replace(case.scene.release, psi_dot=case.scene.release.psi_dot * (1.0 + off))
        motion = sample_truth(truth(replace(case.scene, release=release)))
        steps = round(float(motion.time[-1]) / timestep)
        seconds = steps * float(chosen["price"])  # type: ignore[arg-type]
        return Simulation(
            case=case,
            outcome=Outcome.DIVERGED if chosen["breaks"] else Outcome.FINISHED,
            trajectory=motion,
            engine_version=self.version,
            model=self.name,
            timestep=timestep,
            settings=chosen,
            steps=steps,
            cpu_s=seconds,
            wall_s=seconds,
            setup_s=0.01,
        )


class _Entry:
    value = "harness.a_toy:Toy"  # as if it were ours, which needs no trial
    dist = None

    def load(self) -> type[Toy]:
        """Return the engine, as an entry point does."""
        return Toy


@pytest.fixture(scope="module")
def toy() -> Iterator[str]:
    """Register the toy engine and return its name."""
    known = registry._entries  # noqa: SLF001 - where an installed package would be found
    # the toy claims its cost, and never varies: three repeats say it all
    registry.engine.cache_clear()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(timing, "PATIENCE", 0.0)
        patch.setattr(registry, "_entries", lambda: known() | {"toy": _Entry()})
        yield "toy"
    registry.engine.cache_clear()


Studied = Callable[[Path], tuple[Cost, list[Any]]]


@pytest.fixture(scope="module")
def study(toy: str) -> Studied:
    """Return a function that runs the study of the toy with a folder to keep things in."""
    scene: Scene = load("gentle-rock")
    other = replace(scene, name="other", release=replace(scene.release, psi_dot=1.5))

    def run_it(folder: Path) -> tuple[Cost, list[Any]]:
        study_of_toy = CostStudy(plan=plan_cost(scene, other, [toy], "quick"))
        worked: list[Any] = []

        class Noted(SerialExecutor):
            def submit(self, *words: Any) -> Any:  # type: ignore[override]
                worked.append(words[-1])
                return super().submit(*words)

        done = run_study(
            study_of_toy,
            executor=Noted(),
            cache=CacheFolder(folder=folder),
            timer=lambda: nullcontext(Noted()),
        )
        return study_of_toy.findings(done), worked

    return run_it


@pytest.fixture(scope="module")
def found(study: Studied, tmp_path_factory: pytest.TempPathFactory) -> Cost:
    """Return the study of the toy."""
    return study(tmp_path_factory.mktemp("kept"))[0]


def fall(found: Cost, name: str) -> dict[Any, Any]:
    rows = orders(found, ("turn_deg",)).frame.to_dict("records")
    return next(row for row in rows if row["settings"] == name)


@pytest.mark.parametrize(("name", "order"), [("first order", 1.0), ("second order", 2.0)])
def test_the_order_is_within_a_twentieth(found: Cost, name: str, order: float) -> None:
    seen = fall(found, name)
    assert math.isnan(seen["plateau"])
    assert seen["order"] == pytest.approx(order, abs=0.05)
    assert seen["confidence"] < 0.05
    assert seen["cause"] == ""


def test_the_plateau_is_within_a_tenth_and_has_its_cause(found: Cost) -> None:
    scene = load("gentle-rock")
    release = replace(scene.release, psi_dot=scene.release.psi_dot * (1.0 + 0.1 * OFF))
    level = math.degrees(
        truth(replace(scene, release=release)).bounces[0].angle_of_turn
        - truth(scene).bounces[0].angle_of_turn
    )
    seen = fall(found, "levelled")
    assert seen["plateau"] == pytest.approx(abs(level), rel=0.1)
    assert seen["cause"] == "levelled: a level of its own."
    assert seen["order"] == pytest.approx(1.0, abs=0.05)


def test_the_front_is_exact(found: Cost) -> None:
    table = points(found).frame
    front = {(s, t) for s, t, on in table[["settings", "timestep_s", "on_front"]].values if on}
    # errors go with h for the first order and with h^2 for the second, h = step/1e-3;
    # costs with 1/h and with 2.5/h. So the second at 3e-4 (error 0.09 for 8.3) beats the first at
    # 1e-4 (0.1 for 10), and so on; at 1e-3 it errs as much as the first and costs more
    assert front == {
        ("first order", 1e-3),
        ("first order", 3e-4),
        ("second order", 3e-4),
        ("second order", 1e-4),
        ("second order", 3e-5),
        ("second order", 1e-5),
    }


def test_a_cost_is_what_the_engine_claims_over_the_simulated_time(found: Cost) -> None:
    for point in found.points:
        price = dict(point.case.options).get("price", 1e-6)
        claimed = point.run["steps"] * float(price) / point.run["simulated_s"]  # type: ignore[arg-type]
        assert point.cost == pytest.approx(claimed, rel=1e-12, abs=0)
        assert point.times["setup_s"] == 0.01


def test_the_cheapest_is_named_with_its_tie(found: Cost) -> None:
    rung = next(p for p in found.points if p.variant.name == "first order" and p.timestep == 1e-4)
    (row,) = price_rows(found, HERE, rung.error("turn_deg") * 1.001)
    assert row["settings"] == "second order"  # three steps at 2.5 for ten at 1
    (easy,) = price_rows(found, HERE, 1e3)
    assert easy["settings"] == "first order"
    assert set(str(easy["tied_with"]).split(", ")) == {"levelled", "twin"}
    assert str(easy["verdict"]) == "cheapest"
    assert easy["relative_cost"] == 1.0


def test_what_no_setting_reaches_is_said(found: Cost) -> None:
    (row,) = price_rows(found, HERE, 1e-12)
    assert str(row["verdict"]).startswith("not reached: best is ")
    assert row["settings"] == "second order"


def test_settings_are_tuned_on_the_other_scene(found: Cost) -> None:
    assert found.tuned == {
        ("toy", FIXED): "first order"
    }  # coarse steps reach a tenth of a degree there
    sold = {offer.point.variant.name for offer in found.sold("toy", FIXED)}
    assert sold == {"first order"}


def test_failures_are_rows_and_are_not_sold(found: Cost) -> None:
    table = points(found).frame
    broken = table[table["settings"] == "broken"]
    assert len(broken) == 5
    assert broken["outcome"].str.startswith("diverged").all()
    assert not broken["on_front"].any()
    assert all(
        math.isinf(o.error) for o in found.sold("toy", HERE) if o.point.variant.name == "broken"
    )


def test_every_point_has_its_command(found: Cost) -> None:
    table = points(found).frame
    assert table["command"].str.startswith("rockingcan run gentle-rock --engine toy").all()
    assert table["command"].is_unique


@pytest.mark.slow
def test_what_was_measured_is_not_measured_again(study: Studied, tmp_path: Path) -> None:
    first, worked = study(tmp_path)
    assert worked
    second, again = study(tmp_path)
    assert again == []
    for target in (1.0, 0.01, 1e-4):
        one, other = (price_rows(found, HERE, target) for found in (first, second))
        assert one == other


@pytest.mark.slow
def test_a_repeated_study_has_the_same_winners(found: Cost, study: Studied, tmp_path: Path) -> None:
    other, _ = study(tmp_path)
    for target in (1.0, 0.1, 0.01, 1e-3, 1e-4):
        assert price_rows(found, HERE, target) == price_rows(other, HERE, target)


def test_artefacts_are_whole_and_no_price_stands_without_the_contract(found: Cost) -> None:
    artefacts = cost_report(found)
    names = [artefact.name for artefact in artefacts]
    assert len(set(names)) == len(names)
    assert_two_sentences(artefacts)
    assert names.index("gentle-rock-contract") < names.index("gentle-rock-prices")
    for artefact in artefacts:
        if isinstance(artefact, Table):
            assert set(artefact.frame.columns) == set(artefact.columns)
        if isinstance(artefact, Figure):
            for panel in artefact.panels:
                assert panel.x_range == (1e-3, 1e3)
                assert all(len(s.hover) == len(s.x) for s in panel.series)
        if isinstance(artefact, Prose):
            assert "nan" not in artefact.text.lower().split()
