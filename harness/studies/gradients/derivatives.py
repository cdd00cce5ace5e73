"""Three derivatives of a bounce: exact, by differences of runs, and an engine's own."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from harness.core.case import Case
from harness.core.trajectory import Floats, Trajectory
from harness.engines.base import features_of
from harness.engines.linearised import LinearisedMotion, change_between
from harness.engines.reference.derivatives import derivatives_of, nutation_derivatives
from harness.engines.reference.truth import exact_motion
from harness.engines.registry import description_of, engine
from harness.engines.remote import call_at_engine
from harness.evaluation.effort import (
    engine_group,
    expected_seconds,
    expected_steps,
    simulated_seconds,
)
from harness.evaluation.evaluate import check_case, simulate_case
from harness.evaluation.evaluation import Record
from harness.execution.worker import LostTaskError
from harness.metrics import quantities
from harness.metrics.bounces import bounces, hermite
from harness.metrics.motion import motion
from harness.studies.gradients.design import (
    KEYS,
    QUANTITIES,
    instants,
    keys_of,
    quantities_of,
    unit_of,
    value_of,
)
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
    """Return the quantities of the first exact bounce of a scene, and phi at its instants."""
    exact = exact_motion(scene)
    found, times = exact.bounces, instants(scene)
    numbers = {key: of(found[0]) for key, of in _OF_BOUNCE.items()} if found else _NOTHING
    if not times:
        return numbers
    sampled = exact.at(np.array(list(times.values())))
    phi = motion(sampled, scene).angles.phi
    return {**numbers, **dict(zip(times, phi.tolist(), strict=True))}


def numbers_of(case: Case) -> Record:
    """Run a case and return its quantities, `numbers`, how it ended, `ending`, and its `settings`.

    Raises
    ------
    HarnessError
        For wrong use, as `simulate_case` does.
    """
    if case.engine == "reference":
        return {"numbers": dict(exact_numbers(case.scene)), "ending": "", "settings": {}}
    own = simulate_case(case)  # nothing is compared with the truth here
    run = own.trajectory
    numbers: Numbers = dict.fromkeys(quantities_of(case.scene))
    if run is not None and len(run.time) > 1:
        numbers = _numbers_of_motion(run, case.scene)
    return {"numbers": dict(numbers), "ending": own.ending, "settings": dict(own.settings)}


def nutations(trajectory: Trajectory | None, scene: Scene) -> dict[str, float | None]:
    """Return phi of a run at the instants of its scene, rad; None after the run has ended.

    Between two samples phi is the cubic that has their values and rates.
    """
    times = instants(scene)
    if trajectory is None or len(trajectory.time) < 2 or not times:  # noqa: PLR2004 - an interval
        return dict.fromkeys(times)
    run = motion(trajectory, scene)
    found: dict[str, float | None] = {}
    for name, time in times.items():
        # the last sample of a run may be a step before its horizon
        right = int(np.clip(np.searchsorted(run.time, time), 1, len(run.time) - 1))
        width = run.time[right] - run.time[right - 1]
        share = (time - run.time[right - 1]) / width
        if share > _PAST_THE_LAST:
            found[name] = None
            continue
        value = hermite(run.angles.phi, run.angles.phi_dot, right - 1, share, width)
        found[name] = value if math.isfinite(value) else None
    return found


def _lost(case: Case, error: LostTaskError) -> Record:
    nothing = dict.fromkeys(quantities_of(case.scene))
    return {"numbers": nothing, "ending": error.reason, "settings": {}}


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
    times = instants(case.scene)
    if times:
        own = nutation_derivatives(case.scene, np.array(list(times.values())))
        for name, by in zip(times, own, strict=True):
            slopes[name] = {key: by.get(key) for key in keys}
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
    names = quantities_of(scene)
    found: dict[str, dict[str, float | None]] = {quantity: {} for quantity in names}
    for column, key in enumerate(keys):
        size = _DISPLACED * unit_of(scene, key)
        ends = [run.displaced(column, sign * size) for sign in (1.0, -1.0)]
        up, down = (_numbers_of_motion(end, scene) for end in ends)
        for quantity in names:
            a, b = up[quantity], down[quantity]
            found[quantity][key] = None if a is None or b is None else (a - b) / (2.0 * size)
    return found


_PAST_THE_LAST = 2.0
"""Intervals behind the last but one sample up to which phi is still the cubic's."""

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
    numbers = {key: of(found[0]) for key, of in _OF_BOUNCE.items()} if found else _NOTHING
    return {**numbers, **nutations(trajectory, scene)}


def _no_derivatives(case: Case, error: LostTaskError) -> Record:
    return {"slopes": {}, "why": dict.fromkeys(quantities_of(case.scene), error.reason)}


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


def _exact_effort(case: Case) -> float:
    """Return the processor time of exact derivatives, s: by quadrature, or of the whole motion."""
    per_second = _VARIATIONAL * simulated_seconds(case.scene)
    return _QUADRATURE + (per_second if case.scene.effects.declared() else 0.0)


def _own_effort(case: Case) -> float:
    """Return the processor time of an engine's own derivatives, s."""
    description, runs = description_of(case.engine), len(OWN_STEPS)
    differences = runs * _CALLS * expected_steps(case) * description.step_s
    return _PROGRAM if description.compiles else differences


_QUADRATURE, _VARIATIONAL = 0.05, 1.5
"""s of exact derivatives: of an ideal can, and for a second of a motion with effects."""

_CALLS, _PROGRAM = 60.0, 45.0
"""Steps that a derivative of a step takes by central differences; s of compiling a derivative."""

EXACT: Work[Case, Record] = replace(
    _work("exact derivatives", "exact-derivatives", exact_derivatives), effort=_exact_effort
)
"""Differentiate the exact bounce of a case."""

OWN: Work[Case, Record] = replace(
    _work("derivatives of engines", "own-derivatives", own_derivatives),
    lost=_lost_own,
    effort=_own_effort,
)
"""Ask an engine for the derivatives of a case."""
