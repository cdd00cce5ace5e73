"""The cases of the study of cost.

*Scored*: every variant of every engine over its ladder, on the scene: error and time. *Tuning*: the
same on another scene, errors and the time of that one run, from which each engine's settings are
chosen. *Gaps*: at the finest timestep of the engine as it ships, each gap left open alone, to say
what a plateau is made of. *Hardness*: matched at fixed and adaptive steps, on the
same can with its spin turned down. Nothing here runs.

Hardness is the small parameter of the paper, epsilon = B_{-2}^2 (a_p + 1), read off the exact
motion: its bounce comes as near to flat as phi_min = sqrt(epsilon a_p/((a_p + 1) I)), with I/2 the
largest phi (eq01:phi_inner; the paper's 1.43e-10 has the factor a_p + 1, see
`reference.asymptotic.matched`). Psi' and theta' at release are multiplied by one factor, and
epsilon goes with its square.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.engines.base import COMMON, TIMESTEP, Variant, features_of
from harness.engines.ladder import at_rung, finer_by, rungs, takes_timestep
from harness.engines.reference.assumption_checks import check_exact
from harness.engines.reference.to_reference_problem import carried
from harness.engines.reference.truth import truth
from harness.engines.registry import engine, variants
from harness.studies.cost.points import LONGEST, Family, adaptive_family, family, timesteps
from harness.studies.shared.ablation import AblationPath, ablation_path
from models.scene import Horizon, Scene

DECADES = {"quick": (-6, -8, -10), "full": (-4, -5, -6, -7, -8, -9, -10)}
"""Powers of ten of epsilon, from mild to the paper's."""

SUITES = ("quick", "full")

_HARD_STEPS = {"quick": (2.0, 0.6, 0.2), "full": (2.0, 0.6, 0.2, 0.06, 0.02)}
"""rad of precession in a step at its fastest: one degree lies within."""

_HARD_SHARES = {"quick": (4.0, 2.0, 1.0), "full": (16.0, 8.0, 4.0, 2.0, 1.0)}
"""As `harness.studies.cost.points.SHARES`."""

_ROUNDS = 6
"""Of regula falsi in logarithms, each a digit or more: epsilon is nearly a power of the factor."""

_NEAR = 0.02
"""Of epsilon, by which a scene may miss the one asked for."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hardness:
    """One scene of the ladder of hardness, with a family of fixed and of adaptive steps an engine.

    Parameters
    ----------
    scene : Scene
    epsilon : float
    families : tuple of Family
    """

    scene: Scene
    epsilon: float
    families: tuple[Family, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class CostPlan:
    """What is to be run.

    Parameters
    ----------
    scene, tuning_scene : Scene
    suite : str
    scored, tuning : tuple of Family
    paths : tuple of AblationPath
        Of each engine that declares gaps, at its finest timestep.
    hardness : tuple of Hardness
    """

    scene: Scene
    tuning_scene: Scene
    suite: str
    scored: tuple[Family, ...]
    tuning: tuple[Family, ...]
    paths: tuple[AblationPath, ...]
    hardness: tuple[Hardness, ...]

    @property
    def engines(self) -> tuple[str, ...]:
        """The engines, in order."""
        return tuple(dict.fromkeys(family.engine for family in self.scored))

    @property
    def target(self) -> str:
        """The error that targets are about."""
        return target_of(self.scene)

    def hard_cases(self) -> tuple[Case, ...]:
        """Return the cases of the ladder of hardness, whose scenes are in no catalogue."""
        return _cases_of(*(family for hard in self.hardness for family in hard.families))

    def timed_cases(self) -> tuple[Case, ...]:
        """Return the cases to time alone: scored, and those of hardness."""
        return tuple(dict.fromkeys((*_cases_of(*self.scored), *self.hard_cases())))

    def cases(self) -> tuple[Case, ...]:
        """Return the cases to run for their errors: all of them."""
        gaps = (case for path in self.paths for case in gap_cases(path).values())
        return tuple(dict.fromkeys((*self.timed_cases(), *_cases_of(*self.tuning), *gaps)))


def _cases_of(*families: Family) -> tuple[Case, ...]:
    """Return the cases of families, each once."""
    return tuple(dict.fromkeys(case for family in families for case in family.cases))


def target_of(scene: Scene) -> str:
    """Return the error that targets are about: of the turn, or without a bounce of orientation."""
    return "turn_deg" if truth(scene).bounces else "rotation_rms_deg"


def plan_cost(
    scene: Scene,
    tuning_scene: Scene,
    engines: Sequence[str],
    suite: str = "quick",
    hard_scene: Scene | None = None,
) -> CostPlan:
    """Return the plan for a scene.

    Parameters
    ----------
    scene : Scene
    tuning_scene : Scene
        Where settings are chosen; another one.
    engines : sequence of str
    suite : str
        One of `SUITES`.
    hard_scene : Scene, optional
        Whose spin is turned down to make the bounce harder; no such ladder if left out.

    Raises
    ------
    HarnessError
        If there is no such engine or suite, or a scene has no exact motion or is
        chaotic.
    """
    if suite not in SUITES:
        raise InvalidSettingError("--suite", suite, " or ".join(SUITES))
    for needed in (scene, tuning_scene):
        check_exact(needed)
    if tuning_scene.release == scene.release and tuning_scene.can == scene.can:
        raise InvalidSettingError("--tune", tuning_scene.name, "another scene than the one scored")
    priced_variants = {name: priced(name, suite) for name in engines}
    stepping = [n for n in engines if any(v.along == finer_by(n) for v in variants(n))]
    finest = timesteps(scene, suite)[-1]
    return CostPlan(
        scene=scene,
        tuning_scene=tuning_scene,
        suite=suite,
        scored=tuple(
            family(scene, name, variant, suite)
            for name, own in priced_variants.items()
            for variant in own
            if _carries(scene, name, variant)
        ),
        tuning=tuple(
            family(tuning_scene, name, variant, "tuning")
            for name in stepping
            for variant in priced_variants[name]
        ),
        paths=tuple(
            ablation_path(scene, name, finest if takes_timestep(name) else None)
            for name in stepping
            if features_of(engine(name)).model_differences
        ),
        hardness=() if hard_scene is None else tuple(_hardness(hard_scene, stepping, suite)),
    )


def priced(name: str, suite: str) -> tuple[Variant, ...]:
    """Return the variants of an engine that a suite runs."""
    return tuple(v for v in variants(name) if suite == "full" or not v.thorough)


def _carries(scene: Scene, name: str, variant: Variant) -> bool:
    """Whether a variant can be run: a model of the reference may be too small for the effects."""
    model = dict(variant.settings).get("model")
    return name != "reference" or model is None or carried(scene, str(model))


def _hardness(scene: Scene, engines: Sequence[str], suite: str) -> Iterator[Hardness]:
    """Yield the scenes of the ladder of hardness that exist for this can."""
    for decade in DECADES[suite]:
        harder = hardened(scene, 10.0**decade)
        size = None if harder is None else epsilon(harder)
        if harder is None or size is None:
            continue
        rate = abs(truth(harder).bounces[0].peak_psi_dot)
        steps = tuple(dict.fromkeys(min(LONGEST, turn / rate) for turn in _HARD_STEPS[suite]))
        families = []
        for name in engines:
            ladder = rungs(name, [float(f"{step:.2g}") for step in steps])
            plain = Case(scene=harder, engine=name)
            cases = tuple(at_rung(plain, value) for value in ladder)
            kind = "fixed step" if takes_timestep(name) else "own steps"
            variant = Variant(name=kind, along=finer_by(name))
            families.append(Family(variant=variant, cases=cases))
            if takes_timestep(name):
                families.append(adaptive_family(harder, name, COMMON[2], _HARD_SHARES[suite]))
        yield Hardness(scene=harder, epsilon=size, families=tuple(families))


def epsilon(scene: Scene) -> float | None:
    """Return the paper's small parameter of a scene, or None if its can does not bounce."""
    bounces = truth(scene).bounces
    if not bounces:
        return None
    can = scene.can
    a_p = can.a + can.h**2
    largest = max(scene.release.phi, bounces[0].phi_min)
    return (a_p + 1.0) / a_p * 2.0 * largest * bounces[0].phi_min ** 2


def hardened(scene: Scene, wanted: float) -> Scene | None:
    """Return the scene with its spin changed so that epsilon is as wanted, for one bounce.

    Returns
    -------
    Scene or None
        None if no such spin is found: a can that stands upright does not bounce gently.
    """
    own = epsilon(scene)
    if own is None or own == 0.0:
        return None
    factor = math.sqrt(wanted / own)
    for _ in range(_ROUNDS):
        harder = _spun(scene, factor, wanted)
        size = epsilon(harder)
        if size is None or not 0.0 < size < math.inf:
            return None
        if abs(size / wanted - 1.0) < _NEAR:
            return harder
        factor *= math.sqrt(wanted / size)
    return None


def _spun(scene: Scene, factor: float, wanted: float) -> Scene:
    release = scene.release
    return replace(
        scene,
        name=f"{scene.name}-epsilon-1e{round(math.log10(wanted))}",
        cite=f"{scene.name} with psi' and theta' multiplied by {factor:.6g}",
        release=replace(
            release, psi_dot=release.psi_dot * factor, theta_dot=release.theta_dot * factor
        ),
        horizon=Horizon(bounces=1),
    )


def gap_cases(way: AblationPath) -> dict[str, Case]:
    """Return by gap the case in which it alone is open, for its share of a plateau.

    All at the timestep of the path, which is no gap of its own here.
    """
    timed = {gap.name for gap in way.gaps if TIMESTEP in gap.settings}
    closed = frozenset(way.names)
    return {name: way.case(closed - {name}) for name in way.names if name not in timed}
