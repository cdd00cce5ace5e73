"""Engines in interpreters of their own that take their time, or never answer."""

import os
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from harness.core.case import Case
from harness.core.environments import VARIABLE
from harness.core.errors import EngineContractError
from harness.core.simulation import Outcome
from harness.engines import registry
from harness.engines.base import resolve
from harness.engines.remote import BrokenEnvironmentError, RemoteEngine, call_at_engine
from harness.evaluation.run_cases import run_cases
from harness.execution.isolated_pool import IsolatedProcessPool
from harness.execution.limits import Limits
from models import Scene
from tests.support.clock import stop_clock, wait_for
from tests.support.environments import described, planted

pytestmark = pytest.mark.engine("mujoco")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Have a folder of environments that is empty."""
    monkeypatch.setenv(VARIABLE, str(tmp_path / "engines"))
    registry.forget_engines()
    yield
    registry.forget_engines()


COMPILING = """
import os, time
from pathlib import Path
from harness.engines import Capabilities
from harness.execution.worker_main import compiling
class Toy:
    name, version, settings = "toy", "1.2", ()
    capabilities = Capabilities(honours=frozenset(), imposes={})
    def timestep(self, case):
        return 1e-3
    def simulate(self, case):
        with compiling(self.name):
            while not Path(os.environ["COMPILED"]).exists():
                time.sleep(0.01)
        raise OSError("compiled, and broken")
"""


def test_the_clock_of_a_run_stands_while_its_engine_compiles_itself_elsewhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, brief: Scene
) -> None:
    monkeypatch.setenv("COMPILED", str(tmp_path / "compiled"))
    place = planted(tmp_path, COMPILING)
    clock, said = stop_clock(monkeypatch), tmp_path / "said"

    def let_it_compile() -> None:
        try:
            wait_for(said)
            for _ in range(20):
                clock.now += 10.0
                time.sleep(0.02)
        finally:
            (tmp_path / "compiled").touch()

    with (
        ThreadPoolExecutor(1) as hand,
        IsolatedProcessPool(1, Limits(seconds=50.0)) as executor,
    ):
        executor.on_compiling = lambda name: said.write_text(name, "utf-8")
        gone_on = hand.submit(let_it_compile)
        (done,) = run_cases([Case(scene=brief, engine=place.name)], executor)
        gone_on.result()
    assert said.read_text("utf-8") == place.name
    assert done.simulation.outcome is Outcome.BROKEN
    assert "compiled, and broken" in done.simulation.note


HANGING = """
import time
from harness.engines import Capabilities, Setting
def never(*_):
    time.sleep(1000)
class Toy:
    name, version = "toy", "1.2"
    settings = (Setting(name="tied", default=0.1, matched=never, meaning="Softness."),)
    capabilities = Capabilities(honours=frozenset(), imposes={})
    timestep = never
"""


@pytest.mark.slow
def test_a_question_that_an_engine_elsewhere_never_answers_is_one_sentence(
    tmp_path: Path, brief: Scene
) -> None:
    place = planted(tmp_path, HANGING)
    other = described("mujoco-there", registry.entry_of("mujoco").value, place.interpreter)
    RemoteEngine(place, registry.engine, 100.0)  # its process is there from now on
    beside = call_at_engine(other.name, os.getpid)
    case = Case(scene=brief, engine=place.name)
    with pytest.raises(EngineContractError, match="does not answer within the 3 s allowed"):
        registry.timestep_of(case, RemoteEngine(place, registry.engine, 3.0))
    # the next has a process of its own; that of another engine goes on
    RemoteEngine(place, registry.engine, 100.0)
    settings = RemoteEngine(place, registry.engine, 3.0).settings
    with pytest.raises(BrokenEnvironmentError, match="does not answer within the 3 s allowed"):
        resolve(case, settings, 1e-3)
    assert call_at_engine(other.name, os.getpid) == beside


@pytest.mark.slow
def test_an_engine_that_does_not_answer_in_time_is_one_sentence(tmp_path: Path) -> None:
    place = planted(tmp_path, "import time\ntime.sleep(1000)\n")
    with pytest.raises(BrokenEnvironmentError, match="does not answer within the 3 s allowed"):
        RemoteEngine(place, registry.engine, 3.0)


RAISING = """
from harness.engines import Capabilities
class Toy:
    name, version, settings = "toy", "1.2", ()
    capabilities = Capabilities(honours=frozenset(), imposes={})
    def timestep(self, case):
        raise TimeoutError("of its own")
"""


def test_an_error_of_an_engine_elsewhere_that_is_called_a_timeout_is_its_own(
    tmp_path: Path, brief: Scene
) -> None:
    place = planted(tmp_path, RAISING)
    with pytest.raises(EngineContractError, match="`timestep` raised TimeoutError: of its own"):
        registry.timestep_of(Case(scene=brief, engine=place.name))
