"""What a result claims that cannot be: said of a file without running anything.

A number beats round-off where it is smaller than what one rounding leaves. An orientation is four
numbers between -1 and 1; stored in the precision of the engine, each is off by up to half the
distance to the next number, and so is whatever is measured of the orientation. An eighth of that
distance is below what any run can show whose can has moved, however short its steps: no order of a
method and no count of steps is supposed, so that no honest engine is named.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum

from harness.core.case import Case, Value
from harness.core.simulation import Outcome
from harness.engines.description import Precision
from harness.engines.registry import description_of, installed, missing_effects, names
from harness.results.result import Result
from harness.results.scores import (
    BY_COLUMN,
    CaseIdentity,
    QuantityKind,
    Score,
    division_of,
    identity,
    scene_digest,
)
from harness.studies.comparison.suite import SUITES, suite_cases
from models.catalogue import load
from models.scene import Scene

EngineSettings = Mapping[str, Mapping[str, Value]]


class Rule(Enum):
    """What a result does not keep to."""

    FILE = "a file of the published schema"
    SUITE = "a suite of this program"
    SCENE = "the scenes of this program"
    CASES = "every case of the suite, and no other"
    DIVISION = "the division that profile and settings give"
    DIGEST = "the digest of the case in its version of the engine"
    VALUES = "numbers that a run can have"
    ROUND_OFF = "errors that round-off allows"
    STEPS = "steps that reach the horizon"
    SPREAD = "a spread that fits its members"
    RERUN = "the numbers of the same case, run here"


@dataclass(frozen=True, slots=True, kw_only=True)
class Objection:
    """What there is to object to in a result.

    Parameters
    ----------
    rule : Rule
    case : str
        Label of the case; empty where it is the file as a whole.
    text : str
        What was found.
    """

    rule: Rule
    case: str = ""
    text: str


def objections(result: Result, on_top: EngineSettings) -> Iterator[Objection]:
    """Yield what a result claims that cannot be.

    Parameters
    ----------
    result : Result
    on_top : mapping
        Its settings by engine and name, as a case has them. An engine of which some are not known
        here is left out, and the digests of its open cases are not checked.
    """
    designed, other = designed_cases(result), changed_scenes(result)
    scenes = _scenes(result.suite)
    if not scenes:
        text = f"there is no suite '{result.suite}'; there are {', '.join(SUITES)}"
        yield Objection(rule=Rule.SUITE, text=text)
    for name in other:
        text = f"'{name}' is {result.inputs[name]}, and another motion here: "
        yield Objection(rule=Rule.SCENE, text=text + scene_digest(scenes[name]))
    yield from _cases(result, designed)
    for score in result.cases:
        scene, same = scenes.get(score.scene), score.scene not in other
        checks = {
            Rule.DIVISION: _division(score, result),
            Rule.DIGEST: _digest(score, result, designed, on_top) if same else (),
            Rule.VALUES: _values(score),
            Rule.ROUND_OFF: _round_off(score, scene) if scene else (),
            Rule.STEPS: _steps(score, scene) if scene else (),
            Rule.SPREAD: _spread(score, result),
        }
        for rule, texts in checks.items():
            for text in texts:
                yield Objection(rule=rule, case=score.identity.label(), text=text)


def designed_cases(result: Result) -> dict[CaseIdentity, Case]:
    """Return the cases that the suite of a result has of its engines, without settings on top.

    Engines that are not registered here have none.
    """
    if not (scenes := _scenes(result.suite)):
        return {}
    known = [engine for engine in result.engines if engine in names()]
    return {identity(case): case for case in suite_cases(result.suite, known, scenes)}


def changed_scenes(result: Result) -> tuple[str, ...]:
    """Return the scenes of the suite of a result that are other motions here."""
    return tuple(
        name
        for name, scene in _scenes(result.suite).items()
        if result.inputs.get(name, scene_digest(scene)) != scene_digest(scene)
    )


def _scenes(suite: str) -> dict[str, Scene]:
    """Return the scenes of a suite by name; none of a suite that is not known."""
    return {name: load(name) for name in SUITES.get(suite, ())}


def _cases(result: Result, designed: Mapping[CaseIdentity, Case]) -> Iterator[Objection]:
    scores = result.scores
    for name in scores:
        if designed and name not in designed and name.engine in names():
            text = f"the {result.suite} suite has no such case"
            yield Objection(rule=Rule.CASES, case=name.label(), text=text)
    for name, case in designed.items():
        declared = case.scene.effects.declared()
        # what an engine represents, it says itself
        if name in scores or (declared and name.engine not in installed()):
            continue
        if not missing_effects(name.engine, case.scene):
            text = f"the {result.suite} suite has this case, and the result does not"
            yield Objection(rule=Rule.CASES, case=name.label(), text=text)


def _division(score: Score, result: Result) -> Iterator[str]:
    own = division_of(score.engine, score.profile, result.settings)
    if own is not score.division:
        yield f"it is '{score.division.value}', and should be '{own.value}'"


def _digest(
    score: Score,
    result: Result,
    designed: Mapping[CaseIdentity, Case],
    on_top: EngineSettings,
) -> Iterator[str]:
    case = designed.get(score.identity)
    set_here = on_top.get(score.engine, {})
    of_file = [key for key in result.settings if key.rpartition(".")[0] == score.engine]
    if case is None or len(set_here) != len(of_file):
        return
    ran = replace(case, options=(*case.options, *set_here.items()))
    digest = ran.digest(result.engines[score.engine].version)
    if digest != score.digest:
        yield f"its digest is {score.digest}, and should be {digest}"


_SIGNED = frozenset(
    {
        *("angle_of_turn_error_deg", "bounce_time_error_s", "peak_friction_ratio_error"),
        *("energy_drift", "max_penetration_m"),
    }
)
"""Quantities that may be negative; every other is a size, a share or a count."""

_CYCLE_S = 1e-10
"""s: less than one cycle of any processor; no step is computed in it."""


def _values(score: Score) -> Iterator[str]:
    values = score.values
    for column, value in values.items():
        if value < 0.0 and column not in _SIGNED:
            yield f"{column} is {value:g}, and cannot be negative"
        if column.endswith("_fraction") and value > 1.0:
            yield f"{column} is {value:g}, and is a share of the time"
    steps, seconds = values.get("steps", 0.0), values.get("cpu_s", 0.0)
    if not score.finished:
        return
    if steps < 1.0 or steps != math.floor(steps):
        yield f"it reached its horizon in {steps:g} steps"
    if seconds <= steps * _CYCLE_S:
        yield f"its {steps:g} steps took {seconds:g} s of the processor"
    if not any(BY_COLUMN[column].kind is QuantityKind.CONTACT for column in values):
        yield "it reached its horizon, and nothing was measured of its motion"


_OF_A_TURN = ("phi_rms_rad", "psi_rms_rad", "theta_rms_rad", "energy_drift")
"""Errors of what changes where the can bounces: all angles, and both kinds of energy."""


def _round_off(score: Score, scene: Scene) -> Iterator[str]:
    """Yield the errors that are too small: of the orientation in any scene, for a can rolls."""
    scales = {"rotation_rms_rad": 1.0, "contact_locus_rms_m": scene.can.radius}
    if "angle_of_turn_error_deg" in score.values:
        scales |= {"angle_of_turn_error_deg": math.degrees(1.0), **dict.fromkeys(_OF_A_TURN, 1.0)}
    steps = score.values.get("steps", 0.0)
    for column, scale in scales.items():
        value = score.values.get(column)
        least = description_of(score.engine).precision.epsilon / 8.0 * scale
        if value is not None and steps >= 1.0 and abs(value) < least:
            text = f"{column} is {value:g} after {steps:g} steps: less than {least:.2g}"
            yield f"{text}, which one rounding leaves"


def _steps(score: Score, scene: Scene) -> Iterator[str]:
    """Yield what is wrong with the steps of a fixed timestep over a horizon that is a time."""
    seconds, steps = scene.horizon.seconds, score.values.get("steps", 0.0)
    fixed = score.profile == "matched" and score.timestep > 0.0
    # the last step may fall short of the horizon by itself
    if seconds is not None and score.finished and fixed:
        reached = steps * score.timestep
        if reached < seconds * (1.0 - 1e-9) - score.timestep:
            yield f"{steps:g} steps of {score.timestep:g} s are {reached:g} s, not {seconds:g} s"


_MOST_SPREADS = 1e4
"""Times its value that a spread may be. A run has all errors of its members, and is nearer to the
exact motion than they are by luck alone: by so much once in ten thousand."""

_LEAST = {QuantityKind.ERROR: 1e-9, QuantityKind.CONTACT: 1e-3, QuantityKind.COST: 1.0}
"""Sizes that stand for smaller values. Of an error: what the perturbation itself moves. Of a
contact: one that opens in one member alone; 10 m/s of slip are more than a can of these scenes has.
"""

_OF_EVERY_RUN = frozenset(
    column for column, quantity in BY_COLUMN.items() if quantity.kind is not QuantityKind.TIME
) - {"angle_of_turn_error_deg", "bounce_time_error_s", "peak_friction_ratio_error", "energy_drift"}
"""Quantities that each run has which ends as this one; others need a bounce that was recorded."""


def _widths(score: Score) -> Iterator[str]:
    """Yield the spreads that no members have about the value."""
    for column, width in score.spread.items():
        value, kind = score.values.get(column), BY_COLUMN[column].kind
        if value is None:
            continue
        if width is None:
            if set(score.endings) == {Outcome.FINISHED.name} and column in _OF_EVERY_RUN:
                yield f"the spread of {column} is unknown, and every member reached its horizon"
        elif column.endswith("_fraction") and width > 1.0:
            yield f"the spread of {column} is {width:g}, and it is a share of the time"
        elif kind in _LEAST and width > (most := _MOST_SPREADS * max(abs(value), _LEAST[kind])):
            text = f"the spread of {column} is {width:g}, of a value of {value:g}"
            yield f"{text}: it can be {most:.2g}"


def _spread(score: Score, result: Result) -> Iterator[str]:
    total = sum(score.endings.values())
    if score.members == 0 and (score.spread or score.endings):
        yield "it has a spread, and no members"
    if score.members > 0 and total != score.members + 1:
        yield f"it has {score.members} members, and {total} endings of them and its own"
    if score.members > 0 and score.outcome not in score.endings:
        yield f"it ended as {score.outcome}, which is none of its endings"
    if score.members > 0 and not result.perturbed_by:
        yield "it has members, and the result does not say what they were perturbed by"
    for column, width in score.spread.items():
        if width is not None and (width < 0.0 or column not in score.values):
            yield f"the spread of {column} is {width:g}, and its value {score.values.get(column)}"
    yield from _widths(score)
    errors = [
        width
        for column, width in score.spread.items()
        if BY_COLUMN[column].kind is QuantityKind.ERROR and width is not None
    ]
    single = description_of(score.engine).precision is Precision.SINGLE
    if errors and max(errors) == 0.0 and score.members > 0 and not single:
        yield "no error moved at all where releases differ by 1e-9: the members are one run"
