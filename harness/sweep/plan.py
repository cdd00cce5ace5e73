"""The plan of a sweep: its scenes, engine and quantities, divided into partitions.

Every row follows from the plan and its own number, so that any process can make any partition, in
any order, and the sweep is the same to the bit. A partition's size is part of the plan.
"""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.core.case import Case, Value
from harness.core.errors import InvalidSettingError
from harness.engines.reference.derivatives import scene_numbers
from harness.engines.reference.to_reference_problem import compiles
from harness.engines.registry import engine_version
from harness.evaluation.case_cache import code_fingerprint
from harness.evaluation.evaluate import check_case
from harness.sweep.axes import Axis, check_axes, check_sample, checked_scene
from harness.sweep.derivatives import DERIVATIVES, parts_of
from harness.sweep.parameters import Floats
from harness.sweep.sequences import points
from harness.sweep.values import DEFAULT, QUANTITIES, SOURCES
from models.scene import Scene

MOST_ROWS = 1_000_000_000
"""Beyond the points that a Sobol sequence of doubles tells apart."""

EXACT_ROWS = 32_768
"""Rows of a partition by the exact bounce: half a second, one to two megabytes."""

REDUCED_ROWS = 1_048_576
"""Scenes of a partition without rows: a few seconds, and some hundred kilobytes."""

SLOW_REDUCED_ROWS = 2048
"""Likewise where derivatives are asked for: some seconds."""

COMPILED_FROM = 100_000
"""Rows from which on compiled kernels are used: below, reading them takes longer than they save."""

COMPILED_ROWS = 65_536
"""Rows of a partition by compiled kernels: a third of a second, two to four megabytes."""

ENGINE_ROWS = 256
"""Rows of a partition of runs: a batch of an engine, about a second."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepPlan:
    """All that decides the content of a sweep; created and checked by `plan_sweep`.

    Parameters
    ----------
    base : Case
        What is not varied: scene, engine, profile, timestep and options.
    axes : tuple of Axis
    sample : str
        One of `SAMPLES`.
    count, seed : int
        Of a sample; zero for a grid.
    engine_version : str
    program : tuple of (str, str)
        What computes it: packages and their versions, and the fingerprint of the sources.
    quantities : tuple of str
    exact : bool
        By the exact bounce alone.
    compiled : bool
        By compiled kernels, which differ from the arrays of numpy in round-off.
    reduced : bool
        Without rows: of each partition a summary is kept.
    rows_per_partition : int
        Scenes in a partition but the last.
    """

    base: Case
    axes: tuple[Axis, ...]
    sample: str
    count: int
    seed: int
    engine_version: str
    program: tuple[tuple[str, str], ...]
    quantities: tuple[str, ...]
    exact: bool
    compiled: bool
    reduced: bool
    rows_per_partition: int

    @property
    def rows(self) -> int:
        """Number of scenes in all."""
        if self.sample == "grid":
            return math.prod(axis.count or 1 for axis in self.axes)
        return self.count

    @property
    def partitions(self) -> int:
        """Number of partitions."""
        return math.ceil(self.rows / self.rows_per_partition)

    def span(self, index: int) -> range:
        """Return the rows of a partition."""
        start = index * self.rows_per_partition
        return range(start, min(start + self.rows_per_partition, self.rows))

    def places(self, rows: range) -> tuple[NDArray[np.intp], ...]:
        """Return which value of each axis of a grid consecutive rows have, each of shape (n,)."""
        shape = tuple(axis.count or 1 for axis in self.axes)
        return np.unravel_index(np.arange(rows.start, rows.stop), shape)

    def values(self, rows: range) -> dict[str, Floats]:
        """Return the parameters of consecutive rows, each of shape (n,), by their names.

        The last axis of a grid varies fastest.
        """
        if self.sample == "grid":
            places = self.places(rows)
            return {
                axis.name: axis.values(place) for axis, place in zip(self.axes, places, strict=True)
            }
        shares = points(self.sample, self.seed, len(self.axes), rows)
        return {axis.name: axis.at(shares[:, n]) for n, axis in enumerate(self.axes)}

    def to_dict(self) -> dict[str, Any]:
        """Return the plan in JSON's own types; equal plans say the same."""
        return {
            "scene": self.base.scene.to_dict(),
            "over": [axis.text() for axis in self.axes],
            "sample": self.sample,
            "count": self.count,
            "seed": self.seed,
            "engine": self.base.engine,
            "engine_version": self.engine_version,
            "program": dict(self.program),
            "profile": self.base.profile,
            "timestep_s": self.base.timestep,
            "settings": {name: repr(value) for name, value in self.base.options},
            "quantities": list(self.quantities),
            "compiled": self.compiled,
            "reduce": self.reduced,
            "rows_per_partition": self.rows_per_partition,
        }

    def digest(self) -> str:
        """Return 16 hexadecimal digits that name the plan."""
        return digest_of(self.to_dict())


def digest_of(plan: Mapping[str, Any]) -> str:
    """Return 16 hexadecimal digits that name a plan, given in JSON's own types."""
    text = json.dumps(plan, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _in_place_of(unknown: str) -> str:
    """Return the quantities there are, or of an unknown derivative those of its quantity."""
    of = unknown.partition("/")[0]
    if alike := [name for name in DERIVATIVES if name.partition("/")[0] == of]:
        return ", ".join(alike)
    plain = ", ".join(name for name in QUANTITIES if name not in DERIVATIVES)
    return f"{plain}, or a derivative such as d_angle_of_turn_deg/d_release.phi"


def plan_sweep(
    scene: Scene,
    axes: Sequence[Axis],
    *,
    sample: str = "grid",
    count: int | None = None,
    seed: int | None = None,
    engine: str = "reference",
    profile: str = "matched",
    timestep: float | None = None,
    options: tuple[tuple[str, Value], ...] = (),
    quantities: Sequence[str] = (),
    reduce: bool = False,
) -> SweepPlan:
    """Return a plan that can be carried out.

    Raises
    ------
    HarnessError
        For wrong use, before anything runs; the message says what is allowed.
    """
    check_axes(scene, axes)
    check_sample(axes, sample, count, seed)
    asked = tuple(dict.fromkeys(quantities)) or DEFAULT
    for name in asked:
        if name not in QUANTITIES:
            raise InvalidSettingError("--quantity", name, _in_place_of(name))
        if name in DERIVATIVES and engine != "reference":
            allowed = "of the reference only: an engine's runs have no exact derivative"
            raise InvalidSettingError("--quantity", name, allowed)
        if engine == "reference" and SOURCES[name] == "error":
            raise InvalidSettingError(
                "--quantity", name, "of an engine's runs only: the reference has no such error"
            )
    ends = checked_scene(scene, axes)
    for name in asked:
        if SOURCES[name] == "error" and ends.effects.declared():
            raise InvalidSettingError("--quantity", name, "of scenes without effects only")
        if name in DERIVATIVES and parts_of(name)[1] not in scene_numbers(ends):
            allowed = f"by a number of the scene: {', '.join(scene_numbers(ends))}"
            raise InvalidSettingError("--quantity", name, allowed)
    case = Case(scene=ends, engine=engine, profile=profile, timestep=timestep, options=options)
    check_case(case)
    one_by_one = _one_by_one(case, axes, asked)
    exact = not one_by_one
    if reduce and not exact:
        only = "sweeps of the exact bounce: other rows take far longer to compute than to keep"
        raise InvalidSettingError("--reduce", f"a sweep with {one_by_one}", only)
    scenes = count or math.prod(axis.count or 1 for axis in axes)
    compiled = exact and scenes >= COMPILED_FROM and compiles()
    # a derivative takes some milliseconds
    quick = exact and not any(name in DERIVATIVES for name in asked)
    plan = SweepPlan(
        base=replace(case, scene=scene),
        axes=tuple(axes),
        sample=sample,
        count=count or 0,
        seed=seed or 0,
        engine_version=engine_version(engine),
        program=_program(engine, compiled=compiled),
        quantities=asked,
        exact=exact,
        compiled=compiled,
        reduced=reduce,
        rows_per_partition=_rows_per_partition(
            scenes, quick=quick, compiled=compiled, reduce=reduce
        ),
    )
    if not 1 <= plan.rows <= MOST_ROWS:
        raise InvalidSettingError("--over", plan.rows, f"at most {MOST_ROWS} scenes in all")
    return plan


def _one_by_one(case: Case, axes: Sequence[Axis], quantities: Sequence[str]) -> str:
    """Return why the scenes of a sweep are solved one by one; empty if the exact bounce does."""
    if case.engine != "reference":
        return f"runs of {case.engine}"
    if effects := case.scene.effects.declared():
        return f"effects: {', '.join(effects)}"
    if runs := [name for name in quantities if SOURCES[name] != "exact"]:
        return f"--quantity {runs[0]}, which takes a run"
    if options := set(case.options) - {("model", "auto"), ("model", "exact")}:
        return "--set {}={}".format(*min(options, key=str))
    # the exact bounce is whole, whatever the horizon
    horizon = [axis.name for axis in axes if axis.name.startswith("horizon.")]
    return f"--over {horizon[0]}" if horizon else ""


FEWEST_REDUCED = 64
"""Partitions of a sweep without rows, if it has as many scenes as that takes: an interruption loses
one for each core."""


def _rows_per_partition(scenes: int, *, quick: bool, compiled: bool, reduce: bool) -> int:
    """Return how many scenes are a partition."""
    if not quick:
        return SLOW_REDUCED_ROWS if reduce else ENGINE_ROWS
    rows = COMPILED_ROWS if compiled else EXACT_ROWS
    return min(max(scenes // FEWEST_REDUCED, rows), REDUCED_ROWS) if reduce else rows


def _program(engine: str, *, compiled: bool) -> tuple[tuple[str, str], ...]:
    """Return versions and sources of the program: rows of different programs are not mixed."""
    names = ("rockingcan", "numpy", "scipy", *(("numba",) if compiled else ()))
    packages = [(name, version(name)) for name in names]
    return (*packages, ("sources", code_fingerprint(engine, __name__)))
