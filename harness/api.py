"""The library face: simulate a scene, compare engines on it, run the suite; DataFrames out."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from contextlib import nullcontext

import pandas as pd

from harness.core.case import Case, Value
from harness.core.report_model import Artefact
from harness.engines.registry import names
from harness.evaluation.evaluate import evaluate, run_cases
from harness.evaluation.evaluation import Evaluation
from harness.execution.cache import CacheFolder
from harness.execution.isolated_pool import local_executor
from harness.studies.comparison.study import EngineSettings, plan_comparison
from harness.studies.comparison.tables import results
from harness.studies.study import Listener, run_study
from models.catalogue import load
from models.scene import Scene


def simulate(
    scene: Scene | str,
    engine: str = "reference",
    *,
    profile: str = "matched",
    timestep: float | None = None,
    settings: Mapping[str, Value] | None = None,
) -> Evaluation:
    """Run one scene in one engine and hold it against the exact motion.

    Parameters
    ----------
    scene : Scene or str
        A scene, the name of one in the catalogue, or the path of a scene file.
    engine : str
    profile : str
        "matched": only what the scene declares; "default": the engine as it ships; "adaptive":
        matched, with timesteps that follow the motion.
    timestep : float, optional
        s; the profile's own if left out.
    settings : mapping, optional
        Settings that replace the profile's, under the engine's own names.

    Returns
    -------
    Evaluation

    Raises
    ------
    HarnessError, ModelError
        For wrong use. A numerical failure is the `outcome` of the simulation.
    """
    return evaluate(
        Case(
            scene=_scene(scene),
            engine=engine,
            profile=profile,
            timestep=timestep,
            options=tuple((settings or {}).items()),
        )
    )


def compare(
    scene: Scene | str,
    engines: Sequence[str] | None = None,
    *,
    profiles: Sequence[str] = ("default", "matched"),
    timesteps: Sequence[float | None] = (None,),
    jobs: int = 1,
) -> pd.DataFrame:
    """Run one scene in several engines and return a row for each run.

    Parameters
    ----------
    scene : Scene or str
    engines : sequence of str, optional
        All but the reference if left out.
    profiles : sequence of str
    timesteps : sequence of float or None
        s; None is the profile's own. Profile "default" runs at its own timestep only.
    jobs : int
        Processes.

    Returns
    -------
    DataFrame
        The columns of the table `results`, units in their names.
    """
    chosen = _scene(scene)
    cases = [
        Case(scene=chosen, engine=engine, profile=profile, timestep=timestep)
        for engine in stepping_engines(engines)
        for profile in profiles
        for timestep in ((None,) if profile == "default" else timesteps)
    ]
    with local_executor(jobs) as executor:
        return results(run_cases(cases, executor)).frame


def suite(
    name: str, engines: Sequence[str] | None = None, settings: EngineSettings | None = None
) -> tuple[Case, ...]:
    """Return the cases of a suite that its engines can represent.

    Parameters
    ----------
    name : str
        "quick" or "full".
    engines : sequence of str, optional
        All but the reference if left out.
    settings : mapping, optional
        By engine, settings to put on top of every case of it.
    """
    return plan_comparison(name, stepping_engines(engines), settings).cases


def validate(
    name: str = "quick",
    engines: Sequence[str] | None = None,
    *,
    settings: EngineSettings | None = None,
    jobs: int = 1,
    executor: Executor | None = None,
    store: CacheFolder | None = None,
    on_progress: Listener | None = None,
) -> tuple[tuple[Evaluation, ...], tuple[Artefact, ...]]:
    """Run a suite; return its evaluations and the artefacts that a report is made of.

    Parameters
    ----------
    name : str
        "quick" or "full".
    engines : sequence of str, optional
        All but the reference if left out.
    settings : mapping, optional
        By engine, settings to put on top of every case of it.
    jobs : int
        Processes.
    executor : Executor, optional
        Where to run instead; stays open.
    store : CacheFolder, optional
        Where evaluations are kept and found.
    on_progress : callable, optional
        Is told of each evaluation as it is ready, as by `run_study`.
    """
    study = plan_comparison(name, stepping_engines(engines), settings)
    with nullcontext(executor) if executor else local_executor(jobs) as chosen:
        done = run_study(study, executor=chosen, cache=store, on_progress=on_progress)
    return study.evaluations(done), study.report(done)


def stepping_engines(engines: Sequence[str] | None) -> tuple[str, ...]:
    """Return the engines to compare: those named, or all but the reference."""
    if engines:
        return tuple(dict.fromkeys(engines))
    return tuple(name for name in names() if name != "reference")


def _scene(scene: Scene | str) -> Scene:
    """Return a scene itself, or the one of that name or path."""
    return load(scene) if isinstance(scene, str) else scene
