"""A study: the jobs that it asks for, round after round, and the report on their results.

A study is an object that any caller runs: Python, the command line, a gate, a test. It designs jobs
and reads results; `run_study` alone runs, keeps and resumes them.
"""

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from functools import partial
from hashlib import sha256
from itertools import count
from operator import attrgetter
from typing import Any, Generic, Protocol, TypeVar, runtime_checkable

from harness.core.case import Case
from harness.core.provenance import processor
from harness.core.report_model import Artefact
from harness.core.simulation import Simulation
from harness.evaluation.case_cache import case_key, case_metadata, evaluation_cache
from harness.evaluation.effort import engine_group, expected_seconds, expected_timing
from harness.evaluation.evaluate import check_case, evaluate_case
from harness.evaluation.evaluation import Evaluation, Record
from harness.evaluation.run_cases import failed_evaluation
from harness.evaluation.timing import single_thread_executor, time_alone, untimed
from harness.execution.cache import CacheFolder
from harness.execution.estimate import (
    Estimate,
    Expected,
    Taken,
    read_speeds,
    side_by_side,
    write_speeds,
)
from harness.execution.isolated_pool import SerialExecutor
from harness.execution.tasks import ProgressListener, ResultCache, run_tasks
from harness.execution.worker import LostTaskError

Task = TypeVar("Task", bound=Hashable)
Result = TypeVar("Result")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Work(Generic[Task, Result]):
    """A kind of job: the function that does a task, and the cache of its result.

    Parameters
    ----------
    name : str
        Name that the progress bar shows, such as "timing alone".
    call : callable
        A function of a module, so that it can be sent to a process.
    lost : callable
        Returns the result of a task that took its process with it, or was stopped.
    label : callable
        Returns the name of a task that the progress bar shows.
    cache : callable, optional
        Returns the cache of the results in a folder; results are not cached if left out.
    check : callable
        Raises if a task is wrong use; called before anything of its round runs.
    alone : bool
        Nothing else may run on this machine meanwhile, for times are measured.
    effort : callable, optional
        Returns how much work a task is, in seconds of processor on a usual machine: the longest (of
        a topic) begins first, and their sum is the estimate. All tasks count alike if left out.
    group : callable, optional
        Returns the name of the tasks whose efforts are wrong by one factor, such as the runs of an
        engine; all tasks of this kind if left out.
    about : callable, optional
        Returns the topic of a task, such as its scene: see `run_tasks`.
    manifest : callable, optional
        Returns the entry of a run in the manifest of a report; no entry if left out.
    """

    name: str
    call: Callable[[Task], Result]
    lost: Callable[[Task, LostTaskError], Result]
    label: Callable[[Task], str]
    cache: Callable[[CacheFolder], ResultCache[Task, Result]] | None = None
    check: Callable[[Task], None] = lambda _: None
    alone: bool = False
    effort: Callable[[Task], float] = lambda _: 1.0
    group: Callable[[Task], str] = lambda _: ""
    about: Callable[[Task], Hashable] | None = None
    manifest: Callable[[Task, Result], Mapping[str, Any]] | None = None


@dataclass(frozen=True, slots=True)
class Job(Generic[Task, Result]):
    """A task and its kind of work: a case to evaluate or to time alone, or scenes to check."""

    work: Work[Task, Result]
    task: Task

    def expected(self) -> Expected:
        """Return what the job is expected to take."""
        group = f"{self.work.name} {self.work.group(self.task)}".strip()
        return Expected(group, self.work.effort(self.task), self.work.alone)

    def stored(self, cache: CacheFolder | None) -> bool:
        """Whether the result is in a store."""
        known = None if cache is None or self.work.cache is None else self.work.cache(cache)
        return known is not None and known.has(self.task)


class Results:
    """The results of jobs, by kind of work and task.

    Parameters
    ----------
    results : mapping, optional
        By work, the results by task.
    """

    def __init__(self, results: Mapping[Work[Any, Any], Mapping[Any, Any]] | None = None) -> None:
        self._results = {work: dict(of_work) for work, of_work in (results or {}).items()}

    def __contains__(self, job: Job[Any, Any]) -> bool:
        """Whether a job is done."""
        return job.task in self._results.get(job.work, {})

    def of(self, work: Work[Task, Result]) -> dict[Task, Result]:
        """Return the results of one kind of work by task, in the order in which they were asked."""
        return self._results.get(work, {})

    def joined(self, work: Work[Task, Result], results: Mapping[Task, Result]) -> "Results":
        """Return these results and further ones."""
        return Results({**self._results, work: {**self.of(work), **results}})

    def only(self, jobs: Iterable[Job[Any, Any]]) -> "Results":
        """Return the results of the given jobs alone."""
        results: dict[Work[Any, Any], dict[Any, Any]] = {}
        for job in jobs:
            results.setdefault(job.work, {})[job.task] = self._results[job.work][job.task]
        return Results(results)

    def manifest(self) -> list[Mapping[str, Any]]:
        """Return the entry of each run in the manifest of a report."""
        return [
            work.manifest(task, result)
            for work, results in self._results.items()
            if work.manifest is not None
            for task, result in results.items()
        ]


class Study(Protocol):
    """What a study is: it designs jobs, and turns their results into artefacts."""

    @property
    def name(self) -> str:
        """Title of the study, in a few words."""
        ...

    def next_jobs(self, done: Results) -> Iterable[Job[Any, Any]]:
        """Return the jobs wanted, given the results so far; jobs that are done may be among them.

        A study ends when all that it wants is done: so bisection and refinement are studies too.
        """
        ...

    def report(self, done: Results) -> Sequence[Artefact]:
        """Return tables, figures and prose of the results."""
        ...


@runtime_checkable
class ForeseeingStudy(Study, Protocol):
    """A study that can tell jobs of its later rounds, so that the estimate has them."""

    def foreseen(self, done: Results) -> Iterable[Job[Any, Any]]:
        """Return the jobs of later rounds, as far as they can be told."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyGroup:
    """Several studies that run as one, under a name: a job that two of them want is done once."""

    name: str
    studies: tuple[Study, ...]

    def next_jobs(self, done: Results) -> list[Job[Any, Any]]:
        """Return the jobs of all studies."""
        return [job for study in self.studies for job in study.next_jobs(done)]

    def foreseen(self, done: Results) -> list[Job[Any, Any]]:
        """Return the later jobs of all studies that can tell them."""
        able = (study for study in self.studies if isinstance(study, ForeseeingStudy))
        return [job for study in able for job in study.foreseen(done)]

    def report(self, done: Results) -> list[Artefact]:
        """Return the artefacts of all studies, one after the other."""
        return [artefact for study in self.studies for artefact in study.report(done)]


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyProgress:
    """How far the jobs of one kind in one round are.

    Parameters
    ----------
    work : str
        Name of the kind.
    label : str
        Of the task that is done; empty before the first.
    done, total : int
    kept : int
        How many results were there before.
    estimate : Estimate
        Of all that is left, later rounds as well.
    """

    work: str
    label: str
    done: int
    total: int
    kept: int
    estimate: Estimate


Listener = Callable[[StudyProgress], None]
Timer = Callable[[], AbstractContextManager[Executor]]


def run_study(
    study: Study,
    *,
    executor: Executor | None = None,
    cache: CacheFolder | None = None,
    on_progress: Listener | None = None,
    timer: Timer = single_thread_executor,
) -> Results:
    """Run the jobs of a study until it wants no more, each once.

    Parameters
    ----------
    study : Study
    executor : Executor, optional
        Where jobs run; here and one by one if left out.
    cache : CacheFolder, optional
        Store of results; a job whose result is stored is not run again.
    on_progress : callable, optional
        Called at the start of each kind of work in a round, and with each result.
    timer : callable
        Gives the executor of jobs that are timed alone.

    Returns
    -------
    Results
        For the study's own `report`.

    Raises
    ------
    HarnessError
        Before anything of a round runs, if one of its jobs is wrong use.
    """
    results = Results()
    usual = SerialExecutor() if executor is None else executor
    listen = on_progress or (lambda _: None)
    speeds = {} if cache is None else read_speeds(cache.folder)
    estimate = Estimate(*side_by_side(usual), speeds)
    try:
        while wanted := [j for j in dict.fromkeys(study.next_jobs(results)) if j not in results]:
            for job in wanted:
                job.work.check(job.task)
            foreseen = study.foreseen(results) if isinstance(study, ForeseeingStudy) else ()
            later = (job for job in foreseen if job not in results)
            left = (j for j in dict.fromkeys((*wanted, *later)) if not j.stored(cache))
            estimate.expect({job: job.expected() for job in left})
            for work in dict.fromkeys(job.work for job in wanted):
                tasks = [job.task for job in wanted if job.work is work]
                with timer() if work.alone else nullcontext(usual) as chosen:
                    results = results.joined(
                        work,
                        _done(work, tasks, chosen, cache=cache, listen=listen, estimate=estimate),
                    )
    finally:  # one that is stopped has learnt, too
        if cache is not None and estimate.speeds() != speeds:
            write_speeds(cache.folder, estimate.speeds())
    return results


def _done(
    work: Work[Task, Result],
    tasks: Sequence[Task],
    executor: Executor,
    *,
    cache: CacheFolder | None,
    listen: Listener,
    estimate: Estimate,
) -> dict[Task, Result]:
    """Return the results of tasks of one kind, in their order."""
    order = sorted(tasks, key=work.effort, reverse=True)
    kept, done = 0, count()
    progress = partial(StudyProgress, work=work.name, total=len(tasks), estimate=estimate)

    def tell(label: str) -> None:
        listen(progress(label=label, done=next(done), kept=kept))

    def begin(stored: int, _: int) -> None:
        nonlocal kept
        kept = stored
        tell("")

    def finish(task: Task, _: Result, taken: Taken | None) -> None:
        estimate.finish(Job(work, task), taken)
        tell(work.label(task))

    computed = run_tasks(
        order,
        work.call,
        executor,
        lost=work.lost,
        cache=None if cache is None or work.cache is None else work.cache(cache),
        listener=ProgressListener(kept=begin, done=finish),
        about=work.about,
    )
    results = dict(zip(order, computed, strict=True))
    return {task: results[task] for task in tasks}


def case_record(simulation: Simulation) -> Record:
    """Return the entry of a run in the manifest of a report."""
    case = simulation.case
    return {
        "digest": simulation.digest,
        "label": case.label(),
        "command": case.command(),
        "engine": case.engine,
        "engine_version": simulation.engine_version,
        "outcome": simulation.outcome.value,
        "settings": dict(simulation.settings),
    }


def record_cache(kind: str, module: str) -> Callable[[CacheFolder], ResultCache[Case, Any]]:
    """Return a function that gives the cache of one kind of results of cases.

    Parameters
    ----------
    kind : str
    module : str
        Name of the module that makes them: when its sources change, they are made again.
    """

    def cache(store: CacheFolder) -> ResultCache[Case, Any]:
        return ResultCache(
            store=store,
            kind=kind,
            key=lambda case: case_key(case, module),
            metadata=lambda case: case_metadata(case, module),
        )

    return cache


def _timing_cache(store: CacheFolder) -> ResultCache[Case, Record]:
    # times of one processor say nothing of another
    machine = sha256(processor().encode()).hexdigest()[:8]
    return record_cache(f"times-{machine}", time_alone.__module__)(store)


EVALUATION: Work[Case, Evaluation] = Work(
    name="simulating",
    call=evaluate_case,
    lost=failed_evaluation,
    label=Case.label,
    cache=evaluation_cache,
    check=check_case,
    effort=expected_seconds,
    group=engine_group,
    about=attrgetter("scene"),
    manifest=lambda _, evaluation: case_record(evaluation.simulation),
)
"""Run a case and hold it against the exact motion."""

TIMING: Work[Case, Record] = Work(
    name="timing alone",
    call=time_alone,
    lost=untimed,
    label=Case.label,
    cache=_timing_cache,
    check=check_case,
    alone=True,
    effort=expected_timing,
    group=engine_group,
)
"""Time repeated runs of a case while nothing else runs: see `harness.evaluation.timing`."""


def evaluation_jobs(cases: Iterable[Case]) -> list[Job[Case, Evaluation]]:
    """Return the jobs that evaluate cases."""
    return [Job(EVALUATION, case) for case in cases]
