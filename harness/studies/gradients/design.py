"""What is run: small changes of a scene, up and down, by steps over eight decades.

A change is relative to the number that is changed; of a rate that is zero, to sqrt(g/R). A can that
is released at rest in phi starts its first bounce there: a change of that rate alone would make
another bounce the first, and is not asked for.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache

from harness.core.case import Case, Value
from harness.core.errors import InvalidSettingError
from harness.engines.base import TIMESTEP
from harness.engines.ladder import at_rung, chooses_steps, rungs, takes_timestep
from harness.engines.reference.assumption_checks import check_exact, divergence_of, may_be_chaotic
from harness.engines.reference.truth import exact_motion
from harness.engines.registry import missing_effects
from harness.engines.stepping.horizon import natural_time
from harness.metrics.quantities import QUANTITIES as REGISTRY
from harness.studies.cost.points import timesteps
from harness.sweep.parameters import scene_at
from models.errors import InvalidValueError
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


_INSTANTS = 6
"""Times along a motion at which phi is differentiated, evenly spaced up to its horizon."""

_ENGINE_ERROR = 1e-5
"""Error of an engine at the release, taken for granted: where it has grown to 0.1 rad, all ends."""


def instants(scene: Scene) -> dict[str, float]:
    """Return the times at which phi is differentiated too, s, by the names of the quantities.

    They are of a scene that may be chaotic and runs for a time: its first bounce is like any other.
    """
    seconds = scene.horizon.seconds
    if seconds is None or not may_be_chaotic(scene):
        return {}
    times = [float(f"{seconds * place / _INSTANTS:.4g}") for place in range(1, _INSTANTS + 1)]
    return {f"phi_rad_at_{time:g}_s": time for time in times}


def quantities_of(scene: Scene) -> tuple[str, ...]:
    """Return what is differentiated of a scene: its first bounce, and phi at instants."""
    return (*QUANTITIES, *instants(scene))


def label_of(quantity: str) -> str:
    """Return the name of a quantity in figures."""
    if quantity in REGISTRY:
        return REGISTRY[quantity].label
    return f"phi at {quantity.removeprefix('phi_rad_at_').removesuffix('_s')} s"


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
    longest : float
        The longest step, relative.
    decades : int
        From it to the shortest.
    settings : bool
        Whether settings of engines are changed.
    """

    name: str
    keys: tuple[str, ...]
    rungs: str
    count: int
    a_decade: int
    longest: float = 0.1
    decades: int = 8
    settings: bool = True


SUITES = {
    "quick": GradientSuite(
        name="quick",
        keys=(
            *("release.phi", "release.psi_dot", "release.theta_dot"),
            *("can.a", "can.c", "can.h", "can.radius", "gravity"),
        ),
        rungs="tuning",
        count=2,
        a_decade=1,
    ),
    "full": GradientSuite(name="full", keys=KEYS, rungs="quick", count=4, a_decade=2),
    "own": GradientSuite(
        name="own",
        keys=("release.phi", "release.psi_dot", "release.theta_dot"),
        rungs="tuning",
        count=2,
        a_decade=1,
        longest=1e-3,
        decades=1,
        settings=False,
    ),
}
"""quick: some minutes. full: every key, half decades, four timesteps. own: engines' own derivatives
by the release, beside differences of two steps."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GradientPlan:
    """What is differentiated.

    Parameters
    ----------
    scene : Scene
    engines : tuple of str
    suite : GradientSuite
    keys : tuple of str
    chaotic : bool
        Whether disturbances of the motion grow exponentially.
    """

    scene: Scene
    engines: tuple[str, ...]
    suite: GradientSuite
    keys: tuple[str, ...]
    chaotic: bool = False

    @property
    def steps(self) -> tuple[float, ...]:
        """Relative steps of the differences, from long to short."""
        a_decade = self.suite.a_decade
        return tuple(
            float(f"{self.suite.longest * 10.0 ** (-place / a_decade):.2g}")
            for place in range(self.suite.decades * a_decade + 1)
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

    @property
    def settled_bases(self) -> tuple[Case, ...]:
        """The case of each engine whose settings are changed: at its finest timestep."""
        if not self.suite.settings:
            return ()
        last = {
            base.engine: base
            for base in self.bases
            if base.engine != "reference" and base.profile == "matched"
        }
        return tuple(last.values())

    def settings_of(self, base: Case, settings: Mapping[str, object]) -> dict[str, float]:
        """Return the numbers of a case's settings that are changed, by name, with the timestep."""
        found = {}
        if takes_timestep(base.engine) and base.timestep is not None:
            found[TIMESTEP] = base.timestep
        return found | setting_values(settings)

    def steps_of(self, key: str) -> tuple[float, ...]:
        """Return the steps by which a key can be changed up and down, from long to short."""
        return _within_range(self.scene, key, self.steps)

    def changed(self, base: Case, key: str, step: float) -> Case:
        """Return a case with one number changed by a step, relative and with its sign."""
        moved = _moved(self.scene, key, step)
        sign = "up" if step > 0.0 else "down"
        name = f"{self.scene.name[:24]}.{key.replace('_', '-')[-24:]}.{sign}.{abs(step):.2g}"
        return replace(base, scene=replace(moved, name=name.lower()))

    def cases(self) -> Iterator[Case]:
        """Yield every changed case."""
        for base in self.bases:
            for key in self.keys:
                for step in self.steps_of(key):
                    for sign in (1.0, -1.0):
                        yield self.changed(base, key, sign * step)


def _moved(scene: Scene, key: str, step: float) -> Scene:
    return scene_at(scene, {key: value_of(scene, key) + step * unit_of(scene, key)})


@lru_cache(maxsize=64)
def _within_range(scene: Scene, key: str, steps: tuple[float, ...]) -> tuple[float, ...]:
    """Return the steps after which a scene is still one: none of a number at its bound."""
    possible = []
    for step in steps:
        try:
            for sign in (1.0, -1.0):
                _moved(scene, key, sign * step)
        except InvalidValueError:
            continue
        possible.append(step)
    return tuple(possible)


SETTING_STEPS = (1e-2, 1e-3, 1e-4)
"""Relative steps by which a setting of an engine is changed."""


def setting_values(settings: Mapping[str, object]) -> dict[str, float]:
    """Return the numbers among the settings in force that can be changed a little, by name.

    An entry of a setting with several numbers is `name[0]`, `name[1]` and so on.
    """
    found: dict[str, float] = {}
    for name, value in settings.items():
        entries = (
            {f"{name}[{place}]": each for place, each in enumerate(value)}
            if isinstance(value, tuple)
            else {name: value}
        )
        found |= {
            key: each for key, each in entries.items() if isinstance(each, float) and each > 0.0
        }
    return found


def with_setting(base: Case, settings: Mapping[str, object], key: str, factor: float) -> Case:
    """Return a case with one number of its settings multiplied; the key `timestep` is the timestep.

    Parameters
    ----------
    base : Case
    settings : mapping
        In force in the base.
    key : str
        Of `setting_values`, or "timestep".
    factor : float
    """
    if key == TIMESTEP:
        return replace(base, timestep=None if base.timestep is None else base.timestep * factor)
    name, _, place = key.partition("[")
    value = settings[name]
    if isinstance(value, tuple):
        number = int(place.rstrip("]"))
        changed: Value = tuple(
            each * factor if each_place == number else each for each_place, each in enumerate(value)
        )
    else:
        changed = setting_values({name: value})[name] * factor
    kept = tuple((own, given) for own, given in base.options if own != name)
    return replace(base, options=(*kept, (name, changed)))


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
    check_exact(scene, chaotic=True)
    if not exact_motion(scene).bounces:
        raise InvalidSettingError(
            "SCENE", scene.name, "a scene whose exact motion bounces before its horizon"
        )
    chaos = divergence_of(scene)
    if chaos is not None and chaos.chaotic and scene.horizon.seconds is not None:
        # beyond it no engine has a derivative, and most cans have fallen over
        until = min(scene.horizon.seconds, float(f"{chaos.decidable_until(_ENGINE_ERROR):.2g}"))
        scene = replace(scene, horizon=replace(scene.horizon, seconds=until))
    able = tuple(name for name in engines if not missing_effects(name, scene))
    chosen = SUITES[suite]
    keys = keys_of(scene, chosen.keys)
    chaotic = chaos is not None and chaos.chaotic
    if chaotic and suite == "quick":  # each exact run takes seconds
        keys = tuple(key for key in keys if key.startswith("release."))
    return GradientPlan(scene=scene, engines=able, suite=chosen, keys=keys, chaotic=chaotic)
