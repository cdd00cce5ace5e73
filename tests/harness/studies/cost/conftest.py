"""A toy engine whose order, plateau and cost are known, and the study of it."""

from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from harness.core.case import Case, Value
from harness.core.simulation import Outcome, Simulation
from harness.engines import registry
from harness.engines.base import Capabilities, Setting, Variant, resolve
from harness.engines.reference.truth import sample_truth, truth
from harness.evaluation import timing
from harness.execution.cache import CacheFolder
from harness.execution.isolated_pool import SerialExecutor
from harness.studies.cost.design import plan_cost
from harness.studies.cost.prices import Cost
from harness.studies.cost.study import CostStudy
from harness.studies.study import run_study
from models import Scene, load

COARSE = 1e-3
"""s: the coarsest timestep of the gentle release."""

OFF = 1e-3
"""Relative error of psi' at release at the coarsest step: some hundredths of a degree of turn."""


def _setting(name: str, value: Value) -> Setting:
    return Setting(name=name, default=value, matched=value, meaning="As its name says.")


def departure(timestep: float, order: float, level: float) -> float:
    """Return by how much psi' of the toy is off, relatively."""
    return OFF * ((timestep / COARSE) ** order + level)


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
        patch.setattr(timing, "_PATIENCE", 0.0)
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
            def submit(self, call: Any, case: Any, /) -> Any:  # type: ignore[override]  # noqa: ANN401
                worked.append(case)
                return super().submit(call, case)

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
