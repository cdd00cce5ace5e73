"""Engines by name, and one that a third party brings along."""

# ruff: noqa: D102 - the methods of a toy are described where its role is

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, cast

import numpy as np
import pytest

from harness.core.case import Case
from harness.core.errors import (
    HarnessError,
    MissingPackageError,
    UnknownEngineError,
    UnknownSettingError,
    UnsupportedEffectError,
)
from harness.core.report_model import Figure, Prose, Table
from harness.core.simulation import Outcome, Simulation
from harness.engines import registry
from harness.engines.base import Capabilities, Setting, resolve
from harness.engines.reference.truth import truth
from harness.evaluation.evaluate import evaluate
from harness.evaluation.run_cases import run_cases
from harness.studies.comparison.study import comparison_report
from models import Effects, RoundedRim, Scene, Slip


class LateClock:
    """The exact motion on a clock that runs fast by the timestep: an engine of first order."""

    name = "late-clock"
    capabilities = Capabilities(
        honours=frozenset(), imposes=MappingProxyType({"slip": "it slips like any other"})
    )
    settings = (Setting(name="fault", default=1.0, matched=1.0, meaning="Speeds up the clock."),)
    version = "0.1"

    def timestep(self, case: Case) -> float:
        return case.timestep or 1e-3

    def simulate(self, case: Case) -> Simulation:
        chosen = resolve(case, self.settings, self.timestep(case))
        scene = replace(case.scene, effects=Effects())
        own = truth(scene, 1.1 * truth(scene).ends)  # past the maximum that closes the bounce
        dt, fault = self.timestep(case), float(cast("float", chosen["fault"]))
        time = np.arange(0.0, own.ends / (1.0 + dt * fault), dt)
        late = own.at(time * (1.0 + dt * fault))
        names = ("position", "quaternion", "velocity", "angular_velocity", "contact_point")
        fields = {name: getattr(late, name) for name in names}
        trajectory = replace(own.at(time), **fields)
        return Simulation(
            case=case,
            outcome=Outcome.FINISHED,
            trajectory=trajectory,
            engine_version=self.version,
            model=self.name,
            timestep=dt,
            settings=chosen,
            steps=len(time),
        )


def broken() -> object:
    """Fail as an import does whose package is not there."""
    raise ModuleNotFoundError("No module named 'warpdrive'", name="warpdrive")


@dataclass(frozen=True)
class Entry:
    """An entry point."""

    name: str
    load: Callable[[], object]
    value: str = "harness.a_toy:Toy"  # as if it were ours, which needs no trial
    dist: None = None


@pytest.fixture
def toys(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Register an engine of a third party, and one whose package is missing."""
    entries: dict[str, Any] = dict(registry._entries())  # noqa: SLF001 - where entry points come in
    entries |= {
        "late-clock": Entry("late-clock", lambda: LateClock),
        "warp": Entry("warp", broken),
    }
    monkeypatch.setattr(registry, "_entries", lambda: entries)
    registry.engine.cache_clear()
    yield
    registry.engine.cache_clear()


def test_there_are_the_reference_and_two_engines() -> None:
    assert {"mujoco", "pybullet", "reference"} <= set(registry.names())
    assert list(registry.names()) == sorted(registry.names())


@pytest.mark.parametrize("name", ["mujoco", "pybullet", "reference"])
def test_an_engine_knows_its_name_its_version_and_its_settings(name: str) -> None:
    found = registry.engine(name)
    assert found.name == name
    assert found.version[0].isdigit()
    assert found is registry.engine(name)
    names = [setting.name for setting in found.settings]
    assert len(set(names)) == len(names)
    assert all(setting.meaning.endswith(".") for setting in found.settings)


def test_an_unknown_engine_is_refused_with_those_there_are(toys: None) -> None:  # noqa: ARG001
    with pytest.raises(UnknownEngineError) as caught:
        registry.engine("havok")
    assert caught.value.name == "havok"
    assert caught.value.available == tuple(sorted(registry.names()))
    assert isinstance(caught.value, LookupError)
    assert isinstance(caught.value, HarnessError)


def test_a_missing_package_says_how_to_install_it(
    toys: None,  # noqa: ARG001
    gentle: Scene,
) -> None:
    with pytest.raises(MissingPackageError) as caught:
        evaluate(Case(scene=gentle, engine="warp"))
    assert caught.value.part == "engine 'warp'"
    assert caught.value.install.endswith("pip install warpdrive")
    assert isinstance(caught.value, ImportError)


@pytest.mark.engine("pybullet")
def test_an_engine_that_is_missing_is_not_said_to_be_able(
    toys: None,  # noqa: ARG001
    gentle: Scene,
) -> None:
    rounded = replace(gentle, effects=Effects(rim=RoundedRim(radius=1e-3)))
    with pytest.raises(UnsupportedEffectError) as caught:
        registry.check_effects("mujoco", rounded)
    assert (caught.value.engine, caught.value.effect) == ("mujoco", "rim")
    assert caught.value.able == ("pybullet", "reference")


def test_an_imposed_effect_is_no_reason_to_refuse(
    toys: None,  # noqa: ARG001
    gentle: Scene,
) -> None:
    slippery = replace(gentle, effects=Effects(slip=Slip(mu=0.3)))
    registry.check_effects("late-clock", slippery)


def test_a_third_party_engine_is_evaluated_like_any_other(
    toys: None,  # noqa: ARG001
    gentle: Scene,
) -> None:
    e = evaluate(Case(scene=gentle, engine="late-clock", timestep=1e-3))
    assert e.errors is not None
    # late by t dt: at most |phi'| t dt, with phi' below 4 rad/s and t below 0.35 s
    assert 0.0 < e.errors.phi_max < 4.0 * 0.35 * 1e-3
    with pytest.raises(UnknownSettingError) as caught:
        evaluate(Case(scene=gentle, engine="late-clock", options=(("impratio", 1.0),)))
    assert (caught.value.engine, caught.value.name) == ("late-clock", "impratio")
    assert caught.value.available == ("fault",)


def test_a_third_party_engine_takes_part_in_the_comparison(
    toys: None,  # noqa: ARG001
    gentle: Scene,
) -> None:
    cases = [
        Case(scene=gentle, engine=name, timestep=timestep)
        for name in ("late-clock", "mujoco")
        for timestep in (1e-3, 3e-4, 1e-4)
    ]
    found = {artefact.name: artefact for artefact in comparison_report(run_cases(cases))}
    summary, orders_table, angles = (
        found[name] for name in ("summary", "orders", "gentle-rock-angles")
    )
    assert isinstance(summary, Prose)
    assert "late-clock" in summary.text
    assert isinstance(orders_table, Table)
    orders = orders_table.frame
    own = orders[(orders.engine == "late-clock") & (orders.quantity == "phi_rms_rad")]
    # the error is t dt phi' to first order; the next order is dt smaller
    assert own.observed_order.item() == pytest.approx(1.0, abs=5e-3)
    assert own.timesteps.item() == 3
    assert isinstance(angles, Figure)
    labels = {series.label for panel in angles.panels for series in panel.series}
    assert "late-clock, matched, 0.0001 s" in labels
