"""What is run: every setting that asks for an accuracy, over its decades, on hard cases.

Such a setting is a tolerance of an integrator, the accuracy of an engine with error control, or
`eta` of adaptive stepping: alone, and with the largest timestep in proportion to it.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.core.trajectory import Floats
from harness.engines.base import Variant, features_of
from harness.engines.reference.assumption_checks import check_exact
from harness.engines.reference.to_reference_problem import carried
from harness.engines.reference.truth import sample_truth, truth
from harness.engines.registry import engine, missing_effects
from harness.engines.stepping.horizon import natural_time
from harness.engines.stepping.schedule import (
    ETA,
    ETA_SETTING,
    LARGEST_SHARE,
    SMALLEST_SHARE,
    Adaptive,
)
from harness.evaluation.evaluation import Record
from harness.studies.tolerance.delivered import was_lost
from models.catalogue import hard_names, load
from models.scene import Scene


@dataclass(frozen=True, slots=True, kw_only=True)
class ToleranceSuite:
    """How much is run.

    Parameters
    ----------
    name : str
    scenes : tuple of str
    stride : int
        Every so many of the values of a tolerance are run; of `eta` all that can be paid for.
    thorough : bool
        Whether variants that say nearly the same as another are run too.
    most_steps : float
        Expected of a run; values that are expected to take more are not paid for, and told so.
    """

    name: str
    scenes: tuple[str, ...]
    stride: int
    thorough: bool
    most_steps: float


_ALWAYS = ("gentle-rock", "paper-release")

SUITES = {
    "quick": ToleranceSuite(
        name="quick",
        scenes=(*_ALWAYS, "balance-1e-5", "epsilon-1e-12", "fast-spin", "hoop", "tall-can"),
        stride=2,
        thorough=False,
        most_steps=3e4,
    ),
    "full": ToleranceSuite(
        name="full",
        scenes=(*_ALWAYS, *hard_names()),
        stride=1,
        thorough=True,
        most_steps=3e4,
    ),
}
"""quick: about a minute on two cores. full: every hard case that has an exact motion."""

_USUAL_GROWTH = 0.25
"""Power of the tolerance by which the steps of a method of fourth order grow."""

_FASTEST_GROWTH = 1.0
"""The same of a method of first order: a coarser run that lost the motion soon took few steps."""

_UNTOLD = 1e-6
"""Tolerance down to which every solver is cheap; below, coarser runs tell what one takes."""

_ETA = tuple(float(f"{10.0 ** (-power / 2.0):.2g}") for power in range(2, 13))
"""Half a decade apart, from a tenth of the way in a step: each decade costs ten times the steps."""

TOO_MANY = "too many steps are expected"
LOST_BEFORE = "the run of a coarser value was lost with its process"
"""Why finer values are not paid for."""

_TAKEN_DOWN = 1.0 / math.log(2.0)
"""By how much a step is longer than the power of two below it, on average over octaves."""

_LEAST_RATE = 1e-300
"""1/s: of a can at rest, which any step resolves."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Knob:
    """A setting that asks for an accuracy.

    Parameters
    ----------
    engine : str
    variant : Variant
        With the setting in `along`, and its values from coarse to fine.
    with_timestep : bool
        Whether the largest timestep is in proportion to the value.
    """

    engine: str
    variant: Variant
    with_timestep: bool = False

    @property
    def name(self) -> str:
        """What tables and figures call it."""
        return self.variant.name

    def case(self, scene: Scene, value: float) -> Case:
        """Return the case of a scene that asks for a value.

        An engine runs to where the exact motion ends: of a can that lies flat on the plane, a step
        that follows its way has no bound.
        """
        largest = LARGEST_SHARE * natural_time(scene) * value / ETA if self.with_timestep else None
        return Case(
            scene=_to_exact_end(scene) if self.adaptive else scene,
            engine=self.engine,
            profile=self.variant.profile,
            timestep=largest,
            options=(*self.variant.settings, (self.variant.along, value)),
        )

    def values(self, suite: ToleranceSuite) -> tuple[float, ...]:
        """Return what is asked for, from coarse to fine, whether it can be paid for or not."""
        every = tuple(float(v) for v in self.variant.values if isinstance(v, float))
        return every if self.adaptive else every[:: suite.stride]

    def expected_steps(
        self, scene: Scene, value: float, taken: Sequence[tuple[float, int]]
    ) -> float:
        """Return how many steps a run is expected to take, to a factor of some units.

        Of `eta` by the exact motion; of a solver by the steps of its two last coarser runs.

        Parameters
        ----------
        scene : Scene
        value : float
            What is asked for.
        taken : sequence of tuple
            What was asked for in coarser runs, from coarse to fine, and the steps that were taken.

        Returns
        -------
        float
        """
        if self.adaptive:
            return self._adaptive_steps(scene, value)
        if value >= _UNTOLD or not taken:
            return 0.0
        growth = _USUAL_GROWTH
        if len(taken) > 1:
            (coarse, few), (fine, many) = taken[-2:]
            growth = math.log(max(many, 1) / max(few, 1)) / math.log(coarse / fine)
            growth = min(max(growth, 0.0), _FASTEST_GROWTH)
        asked, steps = taken[-1]
        return float(steps * (asked / value) ** growth)

    @property
    def adaptive(self) -> bool:
        """Whether it is `eta` of adaptive stepping."""
        return self.variant.along == ETA_SETTING.name

    def _adaptive_steps(self, scene: Scene, eta: float) -> float:
        """Return the steps that the rule of adaptive stepping takes along the exact motion."""
        times, rates, shares = _demands(scene)
        T = natural_time(scene)
        largest = LARGEST_SHARE * T * (eta / ETA if self.with_timestep else 1.0)
        steps = np.clip(eta * shares / rates, SMALLEST_SHARE * T, largest)
        # of two neighbours the longer: what falls flat ends with steps of no length
        return float((_TAKEN_DOWN * np.diff(times) / np.maximum(steps[1:], steps[:-1])).sum())


@lru_cache(maxsize=64)
def _to_exact_end(scene: Scene) -> Scene:
    """Return a scene that ends where its exact motion does, which may be before its horizon."""
    seconds, ends = scene.horizon.seconds, truth(scene).ends
    if seconds is None or ends >= seconds:
        return scene
    return replace(scene, horizon=replace(scene.horizon, seconds=ends))


@lru_cache(maxsize=64)
def _demands(scene: Scene) -> tuple[Floats, Floats, Floats]:
    """Return times of the exact motion, the rates that a step must resolve, and shares of eta."""
    motion = sample_truth(truth(scene))
    rule = Adaptive(
        scene.can, largest=1.0, smallest=1.0, limit=1.0, eta=1.0, unit=natural_time(scene)
    )
    states = list(zip(motion.quaternion.tolist(), motion.angular_velocity.tolist(), strict=True))
    rates = np.array([rule.rate(*state) for state in states])
    return motion.time, np.maximum(rates, _LEAST_RATE), np.array([rule.eta(*s) for s in states])


def knobs(engines: Sequence[str], suite: ToleranceSuite) -> tuple[Knob, ...]:
    """Return the settings of engines that ask for an accuracy.

    Raises
    ------
    HarnessError
        If an engine does not exist or cannot be made.
    """
    return tuple(knob for name in engines for knob in _knobs_of(name, suite))


def _knobs_of(name: str, suite: ToleranceSuite) -> Iterator[Knob]:
    """Yield those of one engine: declared, of its error control, and of adaptive stepping."""
    chosen = engine(name)
    features = features_of(chosen)
    for variant in features.tolerances:
        if suite.thorough or not variant.thorough:
            yield Knob(engine=name, variant=variant)
    said = features.description
    if said.accuracy_setting:
        own = said.accuracy_setting
        yield Knob(
            engine=name,
            variant=Variant(name=f"{name} {own}", along=own, values=said.accuracies),
        )
    if any(setting.name == ETA_SETTING.name for setting in chosen.settings):
        for words, with_timestep in (("", False), (" and largest step", True)):
            variant = Variant(
                name=f"{name} {ETA_SETTING.name}{words}",
                profile="adaptive",
                along=ETA_SETTING.name,
                values=_ETA,
            )
            yield Knob(engine=name, variant=variant, with_timestep=with_timestep)


@lru_cache(maxsize=8)
def usable_scenes(suite: ToleranceSuite) -> tuple[tuple[Scene, ...], dict[str, str]]:
    """Return the scenes of a suite whose exact motion is known, and why others are left out."""
    scenes: list[Scene] = []
    left_out: dict[str, str] = {}
    for scene in map(load, suite.scenes):
        try:
            check_exact(scene)
        except InvalidSettingError:
            left_out[scene.name] = "it has no exact motion"
            continue
        exact = truth(scene)
        if exact.ends == 0.0:
            left_out[scene.name] = "its motion ends where it begins"
        elif not exact.complete:
            left_out[scene.name] = "its exact motion is not followed to the end"
        else:
            scenes.append(scene)
    return tuple(scenes), left_out


def excluded(knob: Knob, scene: Scene) -> str:
    """Return why a setting cannot be run in a scene; empty if it can."""
    if missing := missing_effects(knob.engine, scene):
        return f"{knob.engine} does not honour {', '.join(sorted(missing))}"
    model = dict(knob.variant.settings).get("model")
    if knob.engine == "reference" and isinstance(model, str) and not carried(scene, model):
        return f"the {model} equations leave out what the scene declares"
    return ""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedLadder:
    """The cases of a setting in a scene, as far as coarser runs tell what can be paid for.

    Parameters
    ----------
    knob : Knob
    scene : Scene
    cases : mapping of float to Case
        By what is asked for, from coarse to fine.
    unpaid : tuple of float
        Values that are not run.
    because : str
        Why they are not; empty if all are.
    excluded : str
        Why there are no cases at all; empty if the setting can be run.
    """

    knob: Knob
    scene: Scene
    cases: Mapping[float, Case]
    unpaid: tuple[float, ...] = ()
    because: str = ""
    excluded: str = ""


def planned_ladder(
    knob: Knob, scene: Scene, suite: ToleranceSuite, records: Mapping[Case, Record]
) -> PlannedLadder:
    """Return the cases of a setting in a scene: of those done, and of those to be done next.

    A solver's finer values wait for the steps of the coarser ones. After a run that was lost with
    its process nobody knows how many steps a finer value takes, and none is run.
    """
    ladder = PlannedLadder(knob=knob, scene=scene, cases={}, excluded=excluded(knob, scene))
    if ladder.excluded:
        return ladder
    values = knob.values(suite)
    cases: dict[float, Case] = {}
    every: list[tuple[float, int]] = []
    taken: list[tuple[float, int]] = []  # by runs with an error: one that fell soon took few steps
    waiting = False
    for place, value in enumerate(values):
        if waiting and value < _UNTOLD:
            break
        if knob.expected_steps(scene, value, taken or every) > suite.most_steps:
            return replace(ladder, cases=cases, unpaid=values[place:], because=TOO_MANY)
        cases[value] = case = knob.case(scene, value)
        record = records.get(case)
        if record is None:
            waiting = not knob.adaptive
        elif was_lost(record):
            finer = values[place + 1 :]
            return replace(ladder, cases=cases, unpaid=finer, because=LOST_BEFORE if finer else "")
        else:
            every.append((value, int(record["steps"])))
            if record["error"] is not None:
                taken.append(every[-1])
    return replace(ladder, cases=cases)
