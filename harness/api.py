"""The library face: simulate a scene, compare engines on it, run the suite; DataFrames out."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from dataclasses import replace

import pandas as pd

from harness.core.case import Case, Value
from harness.core.report_model import Artefact
from harness.engines.registry import names
from harness.evaluation.evaluate import evaluate, run_cases
from harness.evaluation.evaluation import Evaluation
from harness.execution.cache import CacheFolder
from harness.execution.isolated_pool import local_executor
from harness.studies.comparison.report import comparison_report
from harness.studies.comparison.suite import SUITES, Unsupported, split_unsupported, suite_cases
from harness.studies.comparison.tables import results
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
    name: str,
    engines: Sequence[str] | None = None,
    settings: Mapping[str, Mapping[str, Value]] | None = None,
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
    on_top = {engine: tuple(own.items()) for engine, own in (settings or {}).items()}
    return tuple(
        replace(case, options=case.options + on_top.get(case.engine, ()))
        for case in _designed(name, engines)[0]
    )


def _designed(
    name: str, engines: Sequence[str] | None
) -> tuple[tuple[Case, ...], tuple[Unsupported, ...]]:
    """Return the cases of a suite, and what its engines cannot represent of it."""
    scenes = {scene: load(scene) for scene in SUITES[name]}
    return split_unsupported(suite_cases(name, stepping_engines(engines), scenes))


def validate(
    name: str = "quick",
    engines: Sequence[str] | None = None,
    *,
    settings: Mapping[str, Mapping[str, Value]] | None = None,
    jobs: int = 1,
    executor: Executor | None = None,
    store: CacheFolder | None = None,
    on_done: Callable[[Evaluation], None] | None = None,
    on_kept: Callable[[int, int], None] | None = None,
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
    store : Store, optional
        Where evaluations are kept and found.
    on_done : callable, optional
        Is told of each evaluation as it is ready.
    on_kept : callable, optional
        Is told, before anything runs, how many cases are in the store and how many there are.
    """
    with ExitStack() as stack:
        chosen = stack.enter_context(local_executor(jobs)) if executor is None else executor
        evaluations = run_cases(
            suite(name, engines, settings), chosen, on_done, store=store, on_kept=on_kept
        )
    return evaluations, comparison_report(evaluations, _designed(name, engines)[1])


def stepping_engines(engines: Sequence[str] | None) -> tuple[str, ...]:
    """Return the engines to compare: those named, or all but the reference."""
    if engines:
        return tuple(dict.fromkeys(engines))
    return tuple(name for name in names() if name != "reference")


def _scene(scene: Scene | str) -> Scene:
    """Return a scene itself, or the one of that name or path."""
    return load(scene) if isinstance(scene, str) else scene
