"""What is run: small changes of a scene, up and down, by steps over nine decades.

A change is relative to the number that is changed; of a rate that is zero, to sqrt(g/R). A can that
is released at rest in phi starts its first bounce there: a change of that rate alone would make
another bounce the first, and is not asked for.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace

from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.engines.ladder import at_rung, chooses_steps, rungs
from harness.engines.reference.assumption_checks import check_exact
from harness.engines.reference.truth import exact_motion
from harness.engines.registry import missing_effects
from harness.engines.stepping.horizon import natural_time
from harness.studies.cost.points import timesteps
from harness.sweep.parameters import scene_at
from models.scene import Scene

_RATES = ("release.psi_dot", "release.theta_dot")

KEYS = (
    "release.phi",
    *_RATES,
    "release.phi_dot",
    "can.a",
    "can.c",
    "can.h",
    "can.radius",
    "gravity",
)
"""Numbers of a scene that are changed, beside the constants of the effects that it declares."""

QUANTITIES = (
    "angle_of_turn_deg",
    "period_s",
    "phi_min_rad",
    "peak_psi_dot_rad_s",
    "peak_friction_ratio",
)
"""Quantities of the first bounce that are differentiated, by the keys of the registry."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GradientSuite:
    """How much is run.

    Parameters
    ----------
    name : str
    keys : tuple of str
        Those of them that a scene has.
    rungs : str
        Which ladder of timesteps.
    count : int
        How many of its timesteps, from the coarsest.
    a_decade : int
        Steps of a difference in a decade.
    """

    name: str
    keys: tuple[str, ...]
    rungs: str
    count: int
    a_decade: int


SUITES = {
    "quick": GradientSuite(
        name="quick",
        keys=("release.phi", "release.psi_dot", "release.theta_dot", "can.h"),
        rungs="tuning",
        count=2,
        a_decade=1,
    ),
    "full": GradientSuite(name="full", keys=KEYS, rungs="quick", count=4, a_decade=2),
}
"""quick: about two minutes on two cores. full: every key, half decades, four timesteps."""

_DECADES = 8
"""From a step of a tenth to one of 1e-9."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GradientPlan:
    """What is differentiated.

    Parameters
    ----------
    scene : Scene
    engines : tuple of str
    suite : GradientSuite
    keys : tuple of str
    """

    scene: Scene
    engines: tuple[str, ...]
    suite: GradientSuite
    keys: tuple[str, ...]

    @property
    def steps(self) -> tuple[float, ...]:
        """Relative steps of the differences, from long to short."""
        a_decade = self.suite.a_decade
        return tuple(
            float(f"{10.0 ** (-1.0 - place / a_decade):.2g}")
            for place in range(_DECADES * a_decade + 1)
        )

    @property
    def bases(self) -> tuple[Case, ...]:
        """The cases that are changed: each engine at its timesteps, coarse first, then adaptive."""
        return tuple(case for name in self.engines for case in self._bases_of(name))

    def _bases_of(self, name: str) -> Iterator[Case]:
        if name == "reference":
            yield Case(scene=self.scene, engine=name)
            return
        ladder = timesteps(self.scene, self.suite.rungs)[: self.suite.count]
        for value in rungs(name, ladder):
            yield at_rung(Case(scene=self.scene, engine=name), value)
        if not chooses_steps(name):
            yield Case(scene=self.scene, engine=name, profile="adaptive")

    def changed(self, base: Case, key: str, step: float) -> Case:
        """Return a case with one number changed by a step, relative and with its sign."""
        before = value_of(self.scene, key)
        moved = scene_at(self.scene, {key: before + step * unit_of(self.scene, key)})
        sign = "up" if step > 0.0 else "down"
        name = f"{self.scene.name[:24]}.{key.replace('_', '-')[-24:]}.{sign}.{abs(step):.2g}"
        return replace(base, scene=replace(moved, name=name.lower()))

    def cases(self) -> Iterator[Case]:
        """Yield every changed case."""
        for base in self.bases:
            for key in self.keys:
                for step in self.steps:
                    for sign in (1.0, -1.0):
                        yield self.changed(base, key, sign * step)


def value_of(scene: Scene, key: str) -> float:
    """Return a number of a scene by its key."""
    found: object = scene
    for part in key.split("."):
        found = getattr(found, part)
    return float(found)  # type: ignore[arg-type] # a number of a scene


def unit_of(scene: Scene, key: str) -> float:
    """Return what a step of a key is relative to, in its unit."""
    value = abs(value_of(scene, key))
    return 1.0 / natural_time(scene) if value == 0.0 and key in _RATES else value


def keys_of(scene: Scene, wanted: Sequence[str]) -> tuple[str, ...]:
    """Return the keys that can be changed in a scene: those wanted, and constants of effects."""
    constants = [
        f"effects.{effect}.{field.name}"
        for effect in scene.effects.declared()
        for field in fields(getattr(scene.effects, effect))
        if isinstance(value := getattr(getattr(scene.effects, effect), field.name), float)
        and value > 0.0
    ]
    return tuple(key for key in (*wanted, *constants) if unit_of(scene, key) > 0.0)


def plan_gradients(scene: Scene, engines: Sequence[str], suite: str) -> GradientPlan:
    """Return the plan of a scene.

    Raises
    ------
    InvalidSettingError
        If the suite does not exist, or the scene has no exact bounce.
    UnsupportedEffectError
        When it is run, if an engine that is named cannot represent the scene.
    """
    if suite not in SUITES:
        raise InvalidSettingError("--suite", suite, " or ".join(SUITES))
    check_exact(scene)
    if not exact_motion(scene).bounces:
        raise InvalidSettingError("SCENE", scene.name, "a scene whose exact motion bounces")
    able = tuple(name for name in engines if not missing_effects(name, scene))
    chosen = SUITES[suite]
    return GradientPlan(scene=scene, engines=able, suite=chosen, keys=keys_of(scene, chosen.keys))
