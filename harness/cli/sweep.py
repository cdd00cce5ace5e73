"""Many scenes that differ in a few parameters: solved or run, to Parquet, with a curve or a map."""

import os
from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer
from rich.markup import escape

from harness.cli import options, run_options, terminal
from harness.cli.settings import parse_settings
from harness.cli.terminal import to_json
from harness.core.errors import HarnessError, InvalidSettingError
from harness.core.provenance import provenance
from harness.core.report_model import Table, rows_of
from harness.engines.reference import path_taken
from harness.evaluation.effort import expected_seconds
from harness.execution.dask_cluster import check_cluster_address, dask_executor
from harness.execution.isolated_pool import SerialExecutor, local_executor
from harness.execution.limits import Limits, default_limits
from harness.execution.signals import Interrupted
from harness.progress import ItemBar, report_progress
from harness.report.atomic_folder import check_writable
from harness.report.write import write_report
from harness.sweep.axes import read_axis
from harness.sweep.derivatives import DERIVATIVES
from harness.sweep.folder import Folder, opened
from harness.sweep.overview import EXTENTS, Overview, overview, sweep_report
from harness.sweep.plan import SweepPlan, plan_sweep
from harness.sweep.reduction import Reduction
from harness.sweep.run import run_sweep
from models.catalogue import load

REPORT = "report"


_EXACT_SECONDS, _COMPILED_SECONDS = 4e-5, 7e-6
"""s of processor for the exact bounce of a release in a batch, and its share of a partition."""

_DERIVATIVES_SECONDS, _DERIVATIVES_RUN_SECONDS = 2.5e-3, 0.2
"""s of processor for all derivatives of a release in a batch, and of a scene solved by itself: one
column takes as long as many."""


def sweep(  # noqa: PLR0917 - a parameter an option
    scene: options.SceneName,
    over: Annotated[
        list[str],
        typer.Option(
            metavar="NAME=LOW:HIGH:COUNT",
            help="A parameter to vary, such as release.psi_dot=-1:1:401 or can.h=log:0.1:10:50; "
            "repeat it. Without :COUNT for a sample.",
        ),
    ],
    out: Annotated[Path, typer.Option(help="Folder of the sweep; goes on with one begun there.")],
    sample: Annotated[str, typer.Option(help="grid, random, sobol or halton.")] = "grid",
    count: Annotated[int | None, typer.Option(help="Scenes of a sample.")] = None,
    seed: Annotated[int | None, typer.Option(help="Of a sample; 0 if left out.")] = None,
    engine: options.EngineName = "reference",
    profile: options.Profile = "matched",
    timestep: options.Timestep = None,
    set_: options.Settings = None,
    quantity: Annotated[
        list[str] | None,
        typer.Option(help="A column, such as angle_of_turn_deg or epsilon; repeat it."),
    ] = None,
    against: Annotated[
        str | None, typer.Option(help="A quantity to draw the others against, such as epsilon.")
    ] = None,
    reduce: Annotated[  # noqa: FBT002 - a switch of the command line
        bool,
        typer.Option(
            "--reduce", help="Keep no rows: counts, moments, histograms, extremes and the map."
        ),
    ] = False,
    jobs: options.Jobs = None,
    on: options.Cluster = None,
    time_limit: options.TimeLimit = None,
    memory_limit: options.MemoryLimit = None,
    figures: options.Figures = False,  # noqa: FBT002 - a switch of the command line
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
) -> None:
    """A table, and maps, of a scene over its parameters.

    Each combination of values is a row, of the exact motion or of an engine's.

    For example: rockingcan sweep paper-release --over release.psi_dot=-1:1:401
    --over release.theta_dot=-1:1:401 --out reports/signs
    """
    if on is not None:
        check_cluster_address(on)
    workers = jobs or len(os.sched_getaffinity(0))
    limits = run_options.limits_of(workers if on is None else 1, time_limit, memory_limit)
    asked = list(quantity or ())
    if against is not None and quantity and against not in asked:
        asked.append(against)
    chosen = plan_sweep(
        load(scene),
        [read_axis(text) for text in over],
        sample=sample,
        count=count,
        seed=seed,
        engine=engine,
        profile=profile,
        timestep=timestep,
        options=parse_settings(set_ or []),
        quantities=asked,
        reduce=reduce,
    )
    if against is not None and reduce:
        only = "rows: leave out --against or --reduce"
        raise InvalidSettingError("--against", against, only)
    if against is not None and against not in chosen.quantities:
        raise InvalidSettingError("--against", against, ", ".join(chosen.quantities))
    with opened(out, chosen) as folder:
        check_writable(out / REPORT)
        _complete(folder, workers, on, limits)
        result = overview(chosen, folder.read(), against)
    with report_progress() as progress:
        page = write_report(
            sweep_report(result),
            out / REPORT,
            title=f"rockingcan, sweep of {chosen.base.scene.name}",
            cases=(),
            provenance=provenance(reference=path_taken(compiled=chosen.compiled)),
            figures=figures,
            jobs=workers,
            on_progress=progress,
        )
    if json:
        typer.echo(to_json(_answer(result, folder)))
        return
    console = terminal.stdout_console()
    for artefact in sweep_report(result):
        if isinstance(artefact, Table):
            console.print(terminal.table_artefact(artefact))
    console.print(
        escape(f"\nThe {'summaries' if reduce else 'table'}: {folder.parts}\nThe report: {page}")
    )


def _complete(folder: Folder, jobs: int, on: str | None, limits: Limits) -> None:
    """Make the missing partitions with a progress bar; if stopped, say how many are written."""
    chosen, missing = folder.plan, folder.missing()
    left = sum(len(chosen.span(index)) for index in missing)
    for path in folder.damaged:
        typer.echo(f"set aside a damaged partition, to be made again: {path}", err=True)
    if left < chosen.rows:
        there = chosen.rows - left
        typer.echo(f"{there:,} of {chosen.rows:,} scenes are there, {left:,} to go", err=True)
    if not left:
        return
    done, row = 0, _row_seconds(chosen)
    # of what is left alone: what was there before took no time
    efforts = {f"partition {index}": row * len(chosen.span(index)) for index in missing}
    try:
        with (
            _executor(chosen, jobs, on, limits) as executor,
            ItemBar(efforts, "partition", executor, jobs) as bar,
        ):
            bar.label(chosen.base.scene.name)

            def show(part: pd.DataFrame | Reduction) -> None:
                nonlocal done
                done += len(part)
                first = part.start if isinstance(part, Reduction) else part.index[0]
                bar.advance(f"partition {first // chosen.rows_per_partition}")

            window = jobs + 1 if isinstance(executor, ThreadPoolExecutor) else None
            run_sweep(folder, executor, show, window=window)
    except (KeyboardInterrupt, Interrupted, HarnessError) as error:
        written = chosen.rows - left + done
        error.add_note(f"{written:,} of {chosen.rows:,} scenes are written.")
        raise


def _row_seconds(chosen: SweepPlan) -> float:
    """Return about how many seconds of processor a scene takes."""
    derived = any(name in DERIVATIVES for name in chosen.quantities)
    if not chosen.exact:
        return expected_seconds(chosen.base) + derived * _DERIVATIVES_RUN_SECONDS
    plain = _COMPILED_SECONDS if chosen.compiled else _EXACT_SECONDS
    return plain + derived * _DERIVATIVES_SECONDS


@contextmanager
def _executor(chosen: SweepPlan, jobs: int, on: str | None, limits: Limits) -> Iterator[Executor]:
    """Open the executor of a plan; limits are of a scene's run, and the exact bounce has none."""
    executor: Executor
    if on is not None:
        executor = dask_executor(on, default_limits(1) if chosen.exact else limits)
    elif not chosen.exact:
        # never this process, which an engine could take along
        executor = local_executor(jobs, spawned=True, limits=limits)
    elif jobs == 1:
        executor = SerialExecutor()
    else:
        # arrays in compiled loops: threads run them side by side, in the memory of one process
        executor = ThreadPoolExecutor(jobs)
    with executor:
        yield executor


def _answer(result: Overview, folder: Folder) -> dict[str, Any]:
    """Return a sweep as `--json` says it."""
    return {
        "scene": result.plan.base.scene.name,
        "engine": result.plan.base.engine,
        "exact": result.plan.exact,
        "compiled": result.plan.compiled,
        "reduced": result.plan.reduced,
        "over": [axis.text() for axis in result.plan.axes],
        "scenes": result.plan.rows,
        "partitions": result.plan.partitions,
        "digest": result.plan.digest(),
        "parts": str(folder.parts),
        "largest_partition_bytes": folder.largest_partition(),
        "outcomes": dict(result.outcomes),
        "quantities": {
            row.pop("quantity"): row for row in rows_of(EXTENTS, result.extents.values())
        },
    }
