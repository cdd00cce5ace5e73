"""The library face: simulate a scene, compare engines on it, run the suite; DataFrames out.

In a notebook results show themselves, and `plot` draws a quantity of them.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager, nullcontext
from typing import Any, ClassVar

import pandas as pd

from harness.core.case import Case, Value
from harness.core.environments import EVERY_ENGINE
from harness.core.errors import MissingPackageError
from harness.core.report_model import Artefact
from harness.engines.registry import description_of, engine, installed, left_out
from harness.evaluation.evaluate import evaluate
from harness.evaluation.evaluation import Evaluation
from harness.execution.cache import CacheFolder
from harness.execution.isolated_pool import local_executor
from harness.progress import ProgressBar, in_notebook
from harness.studies.comparison.quantity_figures import (
    NothingToDrawError,
    NotRunsError,
    quantity_figure,
)
from harness.studies.comparison.study import ComparisonStudy, EngineSettings, plan_comparison
from harness.studies.comparison.tables import results, run_table
from harness.studies.study import Listener, run_study
from models.catalogue import load
from models.scene import Scene


class Comparison(pd.DataFrame):
    """A row for each run of a comparison, with the runs; a part of it is a plain DataFrame.

    Parameters
    ----------
    evaluations : sequence of Evaluation
        Of one scene.
    """

    _metadata: ClassVar[list[str]] = ["evaluations"]
    evaluations: tuple[Evaluation, ...]

    def __init__(self, evaluations: Sequence[Evaluation]) -> None:
        super().__init__(results(evaluations).frame)  # type: ignore[call-arg]  # stubs have __new__
        self.evaluations = tuple(evaluations)

    def _repr_html_(self) -> str | None:
        """Return what a notebook shows: the frame as it is, and the first figure of the runs."""
        frame: str | None = super()._repr_html_()  # type: ignore[misc]  # not in the stubs
        return None if frame is None else frame + _first_figure(self.evaluations)


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
) -> Comparison:
    """Run one scene in several engines and return a row for each run.

    Parameters
    ----------
    scene : Scene or str
    engines : sequence of str, optional
        Those that take part by default if left out; "all" for every one that is installed.
    profiles : sequence of str
    timesteps : sequence of float or None
        s; None is the profile's own. Profile "default" runs at its own timestep only.
    jobs : int
        Processes.

    Returns
    -------
    Comparison
        A DataFrame with the columns of the table `results`, units in their names.
    """
    chosen = _scene(scene)
    cases = [
        Case(scene=chosen, engine=engine, profile=profile, timestep=timestep)
        for engine in stepping_engines(engines)
        for profile in profiles
        for timestep in ((None,) if profile == "default" else timesteps)
    ]
    study = ComparisonStudy(suite="", designed=tuple(cases))
    with local_executor(jobs) as executor, _notebook_bar() as show:
        return Comparison(study.evaluations(run_study(study, executor=executor, on_progress=show)))


@contextmanager
def _notebook_bar() -> Iterator[Listener | None]:
    """Yield the listener that shows a progress bar in a notebook; elsewhere a library is silent."""
    if not in_notebook():
        yield None
        return
    with ProgressBar() as bar:
        yield bar.show


def plot(what: Evaluation | Comparison | Iterable[Evaluation], quantity: str = "") -> Any:  # noqa: ANN401 - plotly has no types
    """Return the report's figure of a quantity: of one run, of several, or of a comparison.

    Parameters
    ----------
    what : Evaluation, Comparison or iterable of Evaluation
        Runs of one scene; each is drawn, beside the exact motion.
    quantity : str
        "phi", "psi" or "theta", over the whole run and in the first bounce; or a figure of the
        report: "bounce", "angles", "locus", "friction", "residuals", "convergence". Left out, the
        first of these that the runs have.

    Returns
    -------
    plotly.graph_objects.Figure

    Raises
    ------
    HarnessError
        If there is no such quantity, if the runs do not have it or are of several scenes, or if
        these are no runs, such as a part of a comparison: rows have their runs in `evaluations`.
    """
    from harness.report.plotly_renderer import plotly_figure  # noqa: PLC0415 - imports plotly

    return plotly_figure(quantity_figure(_runs(what), quantity))


def to_html(run: Evaluation) -> str:
    """Return a table of one run, and its first figure, as HTML."""
    from harness.report.notebook import table_html  # noqa: PLC0415 - imports matplotlib

    return table_html(run_table(run)) + _first_figure((run,))


def _first_figure(runs: Sequence[Evaluation]) -> str:
    """Return the first figure of the report that runs have, as HTML; nothing if they have none."""
    from harness.report.notebook import figure_html  # noqa: PLC0415 - imports matplotlib

    try:
        return figure_html(quantity_figure(runs))
    except NothingToDrawError:  # runs without a motion; the table says how they ended
        return ""


def _runs(what: Evaluation | Comparison | Iterable[Evaluation]) -> tuple[Evaluation, ...]:
    """Return the runs of a result."""
    if isinstance(what, Comparison):
        return what.evaluations
    runs = tuple(what) if isinstance(what, Iterable) else (what,)
    if not all(isinstance(run, Evaluation) for run in runs):
        raise NotRunsError(type(what).__name__)
    return runs


def suite(
    name: str, engines: Sequence[str] | None = None, settings: EngineSettings | None = None
) -> tuple[Case, ...]:
    """Return the cases of a suite that its engines can represent.

    Parameters
    ----------
    name : str
        "quick" or "full".
    engines : sequence of str, optional
        Those that take part by default if left out; "all" for every one that is installed.
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
        Those that take part by default if left out; "all" for every one that is installed.
    settings : mapping, optional
        By engine, settings to put on top of every case of it.
    jobs : int
        Processes.
    executor : Executor, optional
        Where to run instead; stays open.
    store : CacheFolder, optional
        Where evaluations are kept and found.
    on_progress : callable, optional
        Is told of each evaluation as it is ready, as by `run_study`; in a notebook a progress bar
        if left out.
    """
    study = plan_comparison(name, stepping_engines(engines), settings)
    with (
        nullcontext(executor) if executor else local_executor(jobs) as chosen,
        nullcontext(on_progress) if on_progress else _notebook_bar() as show,
    ):
        done = run_study(study, executor=chosen, cache=store, on_progress=show)
    return study.evaluations(done), study.report(done)


def stepping_engines(engines: Sequence[str] | None) -> tuple[str, ...]:
    """Return the engines to compare: those named, or those that take part by default.

    `EVERY_ENGINE` among the names stands for all that are installed but the reference, without
    those of `unusable_engines`.

    Raises
    ------
    MissingPackageError
        If an engine that is named beside it cannot be made.
    """
    if EVERY_ENGINE in (engines or ()):
        named = [name for name in engines or () if name != EVERY_ENGINE]
        for name in named:
            engine(name)
        broken = unusable_engines()
        return tuple(dict.fromkeys((*(n for n in installed() if n not in broken), *named)))
    if engines:
        return tuple(dict.fromkeys(engines))
    return tuple(name for name in installed() if description_of(name).by_default)


def unusable_engines() -> Mapping[str, str]:
    """Return the engines that are installed and cannot be made, each with the sentence why.

    One that takes part by default is not among them: something is wrong with it, and it is not
    passed over.
    """
    found = {}
    for name in installed():
        try:
            engine(name)
        except MissingPackageError as error:
            if not description_of(name).by_default:
                found[name] = str(error)
    return found


def absent_engines(engines: Sequence[str] | None) -> tuple[str, ...]:
    """Return the engines that `stepping_engines` passes over: not installed, or not usable."""
    if EVERY_ENGINE in (engines or ()):
        return (*left_out(every=True), *unusable_engines())
    return () if engines else left_out()


def _scene(scene: Scene | str) -> Scene:
    """Return a scene itself, or the one of that name or path."""
    return load(scene) if isinstance(scene, str) else scene
