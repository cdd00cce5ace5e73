"""What is run: every setting that asks for an accuracy, over its decades, on hard cases.

Such a setting is a tolerance of an integrator, the accuracy of an engine with error control, or
`eta` of adaptive stepping: alone, and with the largest timestep in proportion to it.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.engines.base import Variant, features_of
from harness.engines.reference.assumption_checks import check_exact
from harness.engines.reference.to_reference_problem import carried
from harness.engines.reference.truth import truth
from harness.engines.registry import engine, missing_effects
from harness.engines.stepping.horizon import natural_time
from harness.engines.stepping.schedule import ETA, ETA_SETTING, LARGEST_SHARE
from harness.evaluation.effort import simulated_seconds
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
        Expected of an adaptive run; finer values of `eta` are left out.
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
        most_steps=1e5,
    ),
}
"""quick: about a minute on two cores. full: every hard case that has an exact motion."""

_ETA = tuple(float(f"{10.0 ** (-power / 2.0):.2g}") for power in range(2, 13))
"""Half a decade apart, from a tenth of the way in a step: each decade costs ten times the steps."""

_STEPS_A_FALL = 4.0
"""Of steps that are 1/eta each, in a bounce: down and up, in phi and in psi."""


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
        """Return the case of a scene that asks for a value."""
        largest = LARGEST_SHARE * natural_time(scene) * value / ETA if self.with_timestep else None
        return Case(
            scene=scene,
            engine=self.engine,
            profile=self.variant.profile,
            timestep=largest,
            options=(*self.variant.settings, (self.variant.along, value)),
        )

    def values(self, scene: Scene, suite: ToleranceSuite) -> tuple[float, ...]:
        """Return what is asked for in a scene, from coarse to fine."""
        every = tuple(float(v) for v in self.variant.values if isinstance(v, float))
        if self.variant.along != ETA_SETTING.name:
            return every[:: suite.stride]
        return tuple(v for v in every if self._steps(scene, v) <= suite.most_steps)

    def _steps(self, scene: Scene, eta: float) -> float:
        """Return how many steps an adaptive run is expected to take, to a factor of some units."""
        bounces = truth(scene).bounces
        folds = sum(math.log(1.0 + scene.release.phi / bounce.phi_min) for bounce in bounces)
        share = LARGEST_SHARE * (eta / ETA if self.with_timestep else 1.0)
        slow = simulated_seconds(scene) / (share * natural_time(scene))
        return slow + _STEPS_A_FALL * (folds + len(bounces)) / eta


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
        if truth(scene).ends == 0.0 or not carried(scene, "rolling"):
            left_out[scene.name] = "it is no motion that rolls, or it ends where it begins"
        else:
            scenes.append(scene)
    return tuple(scenes), left_out


def ladder(knob: Knob, scene: Scene, suite: ToleranceSuite) -> dict[float, Case]:
    """Return the cases of a setting in a scene by what is asked for; none if it cannot be run."""
    if missing_effects(knob.engine, scene):
        return {}
    return {value: knob.case(scene, value) for value in knob.values(scene, suite)}
