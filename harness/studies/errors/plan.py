"""The cases that separate the three errors, and the sentences on their results.

For each way to shrink the timestep: a ladder of timesteps with the solver converged, whose limit is
the engine's own answer; and at one rung of it the solver as it is set, and at lesser efforts. At
that rung, too, an ensemble of slightly perturbed releases.

A setting whose matched value goes with the timestep makes two ways of one engine: tied, it takes
its softness with it as it shrinks; held, it keeps it, and converges neatly to another can.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import chain

from harness.core.case import Case, Value
from harness.core.errors import InvalidSettingError
from harness.engines.base import TIMESTEP, Engine, SolverEffort, features_of
from harness.engines.ladder import at_rung, finer_by, rungs, takes_timestep
from harness.engines.reference.assumption_checks import check_exact
from harness.engines.reference.truth import truth
from harness.engines.registry import engine, timestep_of
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import QUANTITIES, Number, Quantity
from harness.studies.errors.split import ErrorStatus, Split, Spread
from harness.studies.shared.perturbation import MEMBERS, SIZES, perturbed
from models.scene import Scene

Options = tuple[tuple[str, Value], ...]

RUNGS = 5
"""Each half the one before, or as far apart as accuracies are: three give a limit, two more say how
far it can be trusted."""

PROBE = 2
"""The rung, counted from the coarsest, at which solver and ensemble are looked at."""

_TURN_A_STEP = 0.1
"""rad of precession in the coarsest step at its fastest: coarser, no ladder has begun to fall."""

_OF_THE_BOUNCE = ("turn_deg", "bounce_time_s", "phi_min_rad", "peak_friction_ratio")
_OF_THE_END = ("psi_end_deg", "phi_end_deg")


@dataclass(frozen=True, slots=True, kw_only=True)
class Way:
    """A way to shrink the timestep: a name in words, and the settings on the way."""

    name: str
    options: Options


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorsPlan:
    """What is run.

    Parameters
    ----------
    scene : Scene
    engine, profile : str
    ways : tuple of Way
        The first is the one that the ensemble is run on.
    rungs : tuple of float
        Timesteps, s, or accuracies of an engine that chooses its own steps, from coarse to fine.
    efforts : tuple of SolverEffort
        The last is the converged solve; empty if the engine declares none.
    """

    scene: Scene
    engine: str
    profile: str
    ways: tuple[Way, ...]
    rungs: tuple[float, ...]
    efforts: tuple[SolverEffort, ...]

    @property
    def probe(self) -> float:
        """The timestep, s, or the accuracy at which solver and ensemble are looked at."""
        return self.rungs[PROBE]

    @property
    def probe_words(self) -> str:
        """The same in words."""
        along = finer_by(self.engine)
        return f"{self.probe:.2g} s" if along == TIMESTEP else f"{along} {self.probe:.2g}"

    @property
    def at_probe(self) -> str:
        """The same in a sentence, after "at"."""
        of = "a timestep of " if takes_timestep(self.engine) else ""
        return f"{of}{self.probe_words}"

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """The numbers of a run that have a limit: of its first bounce, or of its end."""
        keys = _OF_THE_BOUNCE if self.scene.horizon.seconds is None else _OF_THE_END
        return tuple(QUANTITIES[key] for key in keys)

    def on_ladder(self, way: Way, rung: float) -> Case:
        """Return the case of a rung, with the solver converged."""
        return self.tried(way, self.efforts[-1] if self.efforts else None, rung)

    def tried(self, way: Way, effort: SolverEffort | None, rung: float | None = None) -> Case:
        """Return the case with the solver at an effort, as it is set if that is None."""
        settings = () if effort is None else effort.settings
        case = Case(
            scene=self.scene,
            engine=self.engine,
            profile=self.profile,
            options=tuple((dict(way.options) | dict(settings)).items()),
        )
        return at_rung(case, self.probe if rung is None else rung)

    def member(self, size: float, number: int) -> Case:
        """Return the case of a perturbed release."""
        case = Case(
            scene=perturbed(self.scene, size, number),
            engine=self.engine,
            profile=self.profile,
            options=self.ways[0].options,
        )
        return at_rung(case, self.probe)

    @property
    def rigid(self) -> Case | None:
        """The exact motion of the scene on a rigid contact; None of one that declares no other."""
        if self.scene.effects.compliance is None or self.scene.release.height > 0.0:
            return None
        effects = replace(self.scene.effects, compliance=None)
        return Case(scene=replace(self.scene, effects=effects), engine="reference")

    def cases(self) -> tuple[Case, ...]:
        """Return the cases, each once, the ladder's first."""
        cases = [self.on_ladder(way, step) for way in self.ways for step in self.rungs]
        cases += [self.tried(way, effort) for way in self.ways for effort in (None, *self.efforts)]
        cases += [self.member(size, number) for size in SIZES for number in range(MEMBERS)]
        cases += [] if self.rigid is None else [self.rigid]
        return tuple(dict.fromkeys(cases))


def plan_errors(
    scene: Scene,
    engine_name: str,
    profile: str = "matched",
    *,
    timestep: float | None = None,
    options: Options = (),
) -> ErrorsPlan:
    """Return the plan for a scene in an engine.

    Parameters
    ----------
    scene : Scene
    engine_name : str
    profile : str
        "default" or "matched".
    timestep : float, optional
        The coarsest, s; the profile's own, or a shorter one that the bounce calls for.
    options : tuple of (str, Value)
        Settings on every way.

    Raises
    ------
    HarnessError
        If there is no such engine, it takes no steps, or the scene has no truth or is chaotic.
    """
    check_exact(scene)
    if profile not in {"default", "matched"}:
        raise InvalidSettingError("--profile", profile, "default or matched")
    chosen = engine(engine_name)
    case = Case(scene=scene, engine=engine_name, profile=profile, timestep=timestep)
    coarsest = timestep_of(case)
    if coarsest is None and takes_timestep(engine_name):
        raise InvalidSettingError("--engine", engine_name, "an engine that moves a can by steps")
    if timestep is None and coarsest is not None:
        coarsest = min(coarsest, _resolving(scene))
    halved = tuple((coarsest or 0.0) / 2.0**rung for rung in range(RUNGS))
    return ErrorsPlan(
        scene=scene,
        engine=engine_name,
        profile=profile,
        ways=_ways(chosen, scene, profile, options),
        rungs=rungs(engine_name, halved),
        efforts=features_of(chosen).solver_efforts,
    )


def _resolving(scene: Scene) -> float:
    """Return the longest timestep that a ladder may begin with, to two digits, s."""
    rate = max((abs(bounce.peak_psi_dot) for bounce in truth(scene).bounces), default=0.0)
    if rate == 0.0:
        return math.inf
    longest = _TURN_A_STEP / rate
    digit = 10.0 ** (math.floor(math.log10(longest)) - 1)
    return float(f"{math.floor(longest / digit) * digit:.1e}")


def _ways(chosen: Engine, scene: Scene, profile: str, options: Options) -> tuple[Way, ...]:
    """Return the ways: one, or two if a setting of the profile goes with the timestep.

    A contact that the scene declares goes with nothing: its law is the same at every timestep.
    """
    declared = scene.effects.compliance is not None
    tied = [
        setting
        for setting in chosen.settings
        if profile == "matched"
        and not declared
        and callable(setting.matched)
        and setting.name not in dict(options)
    ]
    if not tied:
        settings = ", ".join(f"{name} {_spelled(value)}" for name, value in options)
        return (Way(name=f"{profile} with {settings}" if settings else profile, options=options),)
    names = ", ".join(setting.name for setting in tied)
    held = tuple((setting.name, setting.default) for setting in tied)
    return (
        Way(name=f"{names} tied", options=options),
        Way(name=f"{names} held", options=options + held),
    )


def _spelled(value: Value) -> str:
    """Return a value in words."""
    return ", ".join(f"{part:g}" for part in value) if isinstance(value, tuple) else str(value)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ThreeErrors:
    """A plan with its evaluations, spreads and split errors.

    Parameters
    ----------
    plan : ErrorsPlan
    evaluations : mapping of Case to Evaluation
    spreads : mapping of (str, float) to Spread
        By quantity and relative size of the perturbations.
    splits : mapping of (str, str) to Split
        By way and quantity.
    """

    plan: ErrorsPlan
    evaluations: Mapping[Case, Evaluation]
    spreads: Mapping[tuple[str, float], Spread]
    splits: Mapping[tuple[str, str], Split]

    @property
    def sentences(self) -> tuple[str, ...]:
        """Two sentences for each way, and one on the spread of perturbed releases."""
        plan = self.plan
        for quantity in plan.quantities:
            splits = {way.name: self.splits[way.name, quantity.key] for way in plan.ways}
            if all(split.total is not None for split in splits.values()):
                pairs = [_way(plan, name, quantity, split) for name, split in splits.items()]
                return (*chain.from_iterable(pairs), self._undecidable(quantity))
        nothing = (
            f"{plan.engine} completes no motion of {plan.scene.name} at {plan.at_probe} that "
            "could be compared, so that its errors cannot be told apart."
        )
        return (nothing,)

    def _undecidable(self, quantity: Quantity) -> str:
        """Return how far releases spread whose difference cannot be measured."""
        small, large = (self.spreads[quantity.key, size] for size in (SIZES[0], SIZES[-1]))
        return (
            f"Releases that differ by {SIZES[-1]:.0e} spread the {quantity.label} by "
            f"{_amount(quantity, large.of_truth, sign=False)} in the exact motion and by "
            f"{_amount(quantity, large.of_engine, sign=False)} in the engine (by "
            f"{_amount(quantity, small.of_truth, sign=False)} and "
            f"{_amount(quantity, small.of_engine, sign=False)} for {SIZES[0]:.0e}): a discrepancy "
            "smaller than that is not decidable."
        )


_VERDICTS = {
    ErrorStatus.MODEL_ERROR: "However small the timestep, this is another can: {}.",
    ErrorStatus.NO_MODEL_ERROR: "For a timestep of zero no model error is seen; {}.",
    ErrorStatus.UNDECIDABLE: "That is less than releases spread that differ by 1e-6; {}.",
    ErrorStatus.UNKNOWN: "Its limit is not known.",
}


def _way(plan: ErrorsPlan, name: str, quantity: Quantity, split: Split) -> tuple[str, str]:
    """Return a sentence on the three errors on one way, and one with the verdict."""
    known, approach = "", "no order is seen on the way to its limit"
    if split.limit is not None:
        known = f" (known to {_amount(quantity, split.limit.uncertainty, sign=False)})"
        if split.limit.order is not None:
            approach = f"it approaches its limit with order {split.limit.order:.2f}"
            if split.limit.spread is not None:
                approach += f", give or take {split.limit.spread:.2f}"
    opening = (
        f"{plan.engine}, {name}, at {plan.at_probe}: the {quantity.label} of "
        f"{plan.scene.name} is off by {_amount(quantity, split.total)}, of which "
        f"model form {_amount(quantity, split.model_form)}{known}, "
        f"discretisation {_amount(quantity, split.discretisation)}, "
        f"solver {_amount(quantity, split.solver)}."
    )
    if split.softness is not None:
        opening += (
            f" The exact motion is that on the declared contact; a rigid one differs from it by "
            f"{_amount(quantity, -split.softness)}."
        )
    verdict = _VERDICTS[split.verdict].replace(TIMESTEP, finer_by(plan.engine))
    return opening, verdict.format(approach)


def _amount(quantity: Quantity, value: Number, *, sign: bool = True) -> str:
    if value is None:
        return "an unknown amount"
    number = f"{value:+.2g}" if sign else f"{value:.2g}"
    return f"{number} {quantity.unit}".rstrip()
