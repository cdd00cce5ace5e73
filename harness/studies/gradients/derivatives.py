"""Three derivatives of a bounce: exact, by differences of runs, and an engine's own."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from harness.core.case import Case
from harness.core.trajectory import Floats, Trajectory
from harness.engines.base import features_of
from harness.engines.linearised import LinearisedMotion, change_between
from harness.engines.reference.derivatives import derivatives_of
from harness.engines.reference.truth import exact_motion
from harness.engines.registry import engine
from harness.engines.remote import call_at_engine
from harness.evaluation.effort import engine_group, expected_seconds, simulated_seconds
from harness.evaluation.evaluate import check_case, evaluate_case
from harness.evaluation.evaluation import Record
from harness.execution.worker import LostTaskError
from harness.metrics import quantities
from harness.metrics.bounces import bounces
from harness.metrics.motion import motion
from harness.studies.gradients.design import KEYS, QUANTITIES, keys_of, unit_of, value_of
from harness.studies.study import Work, record_cache
from harness.sweep.parameters import scene_at
from models.rim import released
from models.scene import Scene

Numbers = Mapping[str, float | None]
"""Quantities of the first bounce by their keys; None where there is none."""

OWN_STEPS = (1e-4, 1e-6, 1e-8)
"""Steps of the differences that an engine takes of its own step, in its own units."""

PROGRAM = "program"
"""In place of that step, of an engine that differentiates its program and takes no differences."""

_OF_BOUNCE = {key: quantities.QUANTITIES[key].of_bounce for key in QUANTITIES}

_NOTHING: Numbers = dict.fromkeys(QUANTITIES)


def exact_numbers(scene: Scene) -> Numbers:
    """Return the quantities of the first exact bounce of a scene."""
    found = exact_motion(scene).bounces
    return {key: of(found[0]) for key, of in _OF_BOUNCE.items()} if found else _NOTHING


def numbers_of(case: Case) -> Record:
    """Run a case and return its quantities, `numbers`, and how it ended, `ending`.

    Raises
    ------
    HarnessError
        For wrong use, as `evaluate_case` does.
    """
    if case.engine == "reference":
        return {"numbers": dict(exact_numbers(case.scene)), "ending": ""}
    evaluation = evaluate_case(case)
    numbers = {key: quantities.QUANTITIES[key].of_run(evaluation) for key in QUANTITIES}
    return {"numbers": numbers, "ending": evaluation.simulation.ending}


def _lost(case: Case, error: LostTaskError) -> Record:
    del case
    return {"numbers": dict(_NOTHING), "ending": error.reason}


def exact_derivatives(case: Case) -> Record:
    """Return the derivatives of the exact bounce.

    Returns
    -------
    dict
        "slopes": by quantity and key, per unit of the key, None where there is none; "why": by
        quantity, why there is none.
    """
    keys, found = keys_of(case.scene, KEYS), derivatives_of(case.scene)
    slopes = {quantity: {key: by.get(key) for key in keys} for quantity, by in found.slopes.items()}
    return {"slopes": slopes, "why": dict(found.why)}


def own_derivatives(case: Case) -> Record:
    """Return the derivatives by the release as the engine differentiates itself.

    Returns
    -------
    dict
        "own": a list, of which each entry has `settings`, those that the engine needs on top of the
        case; `step`, that of the engine's own differences, or `PROGRAM`; `values`, by quantity and
        key; and `why`, a sentence where the engine has none. The list is empty if the engine does
        not differentiate itself.
    """
    return {"own": call_at_engine(case.engine, _own_derivatives, case)}


def _own_derivatives(case: Case) -> list[Record]:
    features = features_of(engine(case.engine))
    linearise, scene = features.linearise, case.scene
    keys = [key for key in keys_of(scene, KEYS) if key.startswith("release.")]
    if linearise is None or case.engine == "reference":
        return []
    changes = np.stack([_of_release(scene, key) for key in keys], axis=1)
    seconds = simulated_seconds(scene) * _PAST_THE_END
    found: list[Record] = []
    for settings in ((), *(variant.settings for variant in features.linearise_variants)):
        changed = replace(case, options=(*case.options, *settings))
        words = ", ".join(f"{name} {value}" for name, value in settings)
        for step in OWN_STEPS:
            run = linearise(changed, changes, seconds=seconds, step=step)
            label = f"{step:g}" if run.by_differences else PROGRAM
            values = {} if run.why else _by_quantity(run, scene, keys)
            found.append({"settings": words, "step": label, "values": values, "why": run.why})
            if not run.by_differences:
                break
    return found


def _by_quantity(run: LinearisedMotion, scene: Scene, keys: Sequence[str]) -> Record:
    """Return by quantity and key what a linearised motion says; None where it has no number."""
    found: dict[str, dict[str, float | None]] = {quantity: {} for quantity in QUANTITIES}
    for column, key in enumerate(keys):
        size = _DISPLACED * unit_of(scene, key)
        ends = [run.displaced(column, sign * size) for sign in (1.0, -1.0)]
        up, down = (_numbers_of_motion(end, scene) for end in ends)
        for quantity in QUANTITIES:
            a, b = up[quantity], down[quantity]
            found[quantity][key] = None if a is None or b is None else (a - b) / (2.0 * size)
    return found


_PAST_THE_END = 1.02
"""Share of the exact motion's time that is differentiated: past its last maximum of phi."""

_DISPLACED = 1e-6
"""Relative size with which a linearised motion is displaced to be measured."""


def _of_release(scene: Scene, key: str) -> Floats:
    """Return the change of the state at the release by a key, shape (12,), per its unit."""
    size = _DISPLACED * unit_of(scene, key)
    before = value_of(scene, key)
    down, up = (released(scene_at(scene, {key: before + sign * size})) for sign in (-1.0, 1.0))
    return change_between(down, up, 2.0 * size)


def _numbers_of_motion(trajectory: Trajectory, scene: Scene) -> Numbers:
    found = bounces(motion(trajectory, scene), scene.can)
    return {key: of(found[0]) for key, of in _OF_BOUNCE.items()} if found else _NOTHING


def _no_derivatives(case: Case, error: LostTaskError) -> Record:
    del case
    return {"slopes": {}, "why": dict.fromkeys(QUANTITIES, error.reason)}


def _lost_own(case: Case, error: LostTaskError) -> Record:
    del case
    return {"own": [{"settings": "", "step": PROGRAM, "values": {}, "why": error.reason}]}


def _work(name: str, kind: str, call: Callable[[Case], Record]) -> Work[Case, Record]:
    return Work(
        name=name,
        call=call,
        lost=_no_derivatives,
        label=Case.label,
        cache=record_cache(kind, __name__),
        check=check_case,
        effort=expected_seconds,
        group=engine_group,
    )


CHANGING: Work[Case, Record] = replace(
    _work("small changes", "bounce-numbers", numbers_of), lost=_lost
)
"""Run a changed case and return the quantities of its first bounce."""

EXACT: Work[Case, Record] = _work("exact derivatives", "exact-derivatives", exact_derivatives)
"""Differentiate the exact bounce of a case."""

OWN: Work[Case, Record] = replace(
    _work("derivatives of engines", "own-derivatives", own_derivatives),
    lost=_lost_own,
    effort=lambda case: 30.0 * expected_seconds(case),
)
"""Ask an engine for the derivatives of a case."""
