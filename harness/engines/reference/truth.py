"""The exact motion of a scene at any instant, and the settings of the reference.

A scene with friction may take seconds to solve, and its motion is asked for as an engine's answer,
as the truth that runs are compared with, and by the command that prints it. So the last motions are
kept in the process, and all three have the same bits.
"""

from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from harness.core.bounce import Bounce
from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.core.public_paths import RenamedValueWarning, warn_renamed
from harness.core.trajectory import Trajectory
from harness.engines.base import Setting, Variant, resolve
from harness.engines.reference.to_reference_problem import problem
from harness.engines.stepping.horizon import natural_time
from harness.engines.world import Floats
from models import Scene, angular_velocity, quaternion
from models.rim import arc_of, contact_offset
from reference import (
    METHODS,
    MODELS,
    RENAMED_METHODS,
    Choice,
    Impact,
    Phase,
    Problem,
    Solution,
    SolverError,
    carries,
    coming_to_rest,
    differences,
    neighbours,
    renamed_method,
    smallest,
    solve,
)
from reference.analysis.conditioning import lost_of_force
from reference.equations.reaction_force import contact_force_in_world
from reference.problem.outcome import UNFINISHED
from reference.smooth.scipy_ivp import SCIPY_METHODS

MOST = 16
"""Most motions held in memory, each of some megabytes at most."""

SCENES = 256
"""Most truths held in memory: a full suite holds its runs against eighty, of a scene up to its
own end and up to those of engines that needed longer."""


def _meant(model: str, problem: Problem) -> str:
    """Return the model that "auto" selects; of a rolling rim the name "auto" is the formula."""
    needed = smallest(problem).model
    return needed if model == "auto" and needed != "rolling" else model


SETTINGS = (
    Setting.as_shipped(
        "model", "auto", "Which equations; auto takes the smallest that carries the scene."
    ),
    Setting.as_shipped(
        "method", "auto", "How they are integrated; auto takes the model's own method."
    ),
    Setting.as_shipped("rtol", 1e-12, "Relative tolerance of the integrator."),
)

_TOLERANCES = (1e-3, 1e-6, 1e-9, 1e-12)

WITHOUT_LOCUS = frozenset({"reduced", "asymptotic"})
"""Models that know the angles alone."""

VARIANTS = (
    Variant(name="exact bounce", settings=(("model", "exact"),), along=""),
    Variant(name="fast integrator", settings=(("model", "rolling"),), along=""),
    *(
        Variant(
            name=f"rolling, {method}",
            settings=(("model", "rolling"), ("method", method)),
            along="rtol",
            values=_TOLERANCES,
            thorough=method not in {"DOP853", "LSODA"},
        )
        for method in ("RK45", "DOP853", "LSODA", "Radau", "BDF")
    ),
    *(
        Variant(
            name=f"{model} model",
            settings=(("model", model),),
            along="",
            imposes="the terms that the model leaves out: model form",
        )
        for model in ("reduced", "asymptotic")
    ),
)
"""Ways to solve a scene; an implicit method in the raw variables is slow where it is stiff."""


_DECADES = tuple(float(f"1e-{power}") for power in range(3, 14))
"""Relative tolerances over ten decades; scipy takes none below 2.2e-14."""

TOLERANCES = (
    *(
        Variant(
            name=name,
            settings=(("model", "rolling"), ("method", method)),
            along="rtol",
            values=_DECADES,
            thorough=method in {"RK23", "Radau", "BDF"},
        )
        for name, method in (
            *((f"scipy {method}", method) for method in SCIPY_METHODS),
            ("half-period", "half-period"),
            ("Picard-Chebyshev", "picard-chebyshev"),
        )
    ),
    Variant(
        name="general equations", settings=(("model", "general"),), along="rtol", values=_DECADES
    ),
)
"""Every integrator over the tolerances that it may be asked for."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Truth:
    """An exact motion in SI units that knows its state at any instant."""

    scene: Scene
    solution: Solution

    @property
    def ends(self) -> float:
        """Time up to which the motion is known, s."""
        return self.solution.t_end * natural_time(self.scene)

    @property
    def complete(self) -> bool:
        """Whether the motion is followed to its end, and does not call for too much work."""
        return self.solution.outcome not in UNFINISHED

    @property
    def rest(self) -> dict[str, float | str | None] | None:
        """How the can came to lie flat, by the keys of `reference --json`; None if it did not."""
        rest = coming_to_rest(self.solution)
        if rest is None:
            return None
        fitted = rest.exponent is not None
        return {
            "t_f_s": rest.time * natural_time(self.scene),
            "law": rest.law or None,
            "exponent": rest.exponent,
            "exponent_predicted": rest.predicted,
            "from_phi_rad": rest.window[1] if fitted else None,
            "to_phi_rad": rest.window[0] if fitted else None,
        }

    @property
    def bounces(self) -> tuple[Bounce, ...]:
        """The bounces of the motion."""
        T, maxima = natural_time(self.scene), self.solution.maxima
        return tuple(
            Bounce(
                start=float(maxima[number]) * T,
                time=bounce.time * T,
                end=float(maxima[number + 1]) * T,
                phi_min=bounce.phi_min,
                angle_of_turn=bounce.angle_of_turn,
                rotation_turn=bounce.rotation_turn,
                peak_psi_dot=bounce.peak_psi_dot / T,
                peak_friction_ratio=bounce.peak_friction_ratio,
            )
            for number, bounce in enumerate(self.solution.bounces)
        )

    @property
    def phases(self) -> tuple[Phase, ...]:
        """Return the intervals in which the rim sticks or slips, in order, their times in s."""
        T, phases = natural_time(self.scene), self.solution.phases
        return tuple(replace(phase, start=phase.start * T, end=phase.end * T) for phase in phases)

    @property
    def impacts(self) -> tuple[Impact, ...]:
        """Return the impacts of the rim in order, in SI units."""
        T, unit = natural_time(self.scene), self.scene.can.mass * self.scene.gravity
        return tuple(
            replace(
                impact,
                time=impact.time * T,
                normal_impulse=impact.normal_impulse * unit * T,
                energy_lost=impact.energy_lost * unit * self.scene.can.radius,
                ends_at=None if impact.ends_at is None else impact.ends_at * T,
            )
            for impact in self.solution.impacts
        )

    @property
    def chosen(self) -> Choice:
        """The smallest model that carries the scene."""
        return smallest(self.solution.problem)

    @property
    def solved_as(self) -> Choice:
        """The model that was asked for, and how it compares with the smallest."""
        solution, needed = self.solution, self.chosen
        why = needed.why
        if solution.model != needed.model:
            why = f"Asked for; the smallest that carries the scene is {needed.model}. {why}"
        return Choice(model=solution.model, equations=solution.equations, why=why)

    def grid(self) -> Floats:
        """Return sampling times that are dense by angle and hold every extremum of phi, s."""
        # impacts may follow each other by an ulp, which a unit of time makes none
        return np.unique(self.solution.grid() * natural_time(self.scene))

    def lost(self, times: Floats) -> Floats:
        """Return the energy that the effects have taken since the release, shape (n,), J.

        Nothing where the rim never slips and nothing resists.
        """
        can, T = self.scene.can, natural_time(self.scene)
        unit = can.mass * self.scene.gravity * can.radius
        return unit * self.solution.lost(np.minimum(times / T, self.solution.t_end))

    def at(self, times: Floats) -> Trajectory:
        """Return the motion at the given times, shape (n,), s, none after `ends`."""
        can, T = self.scene.can, natural_time(self.scene)
        states = self.solution.at(np.minimum(times / T, self.solution.t_end))
        if states.x is None or states.y is None:
            raise InvalidSettingError("model", self.solution.model, "one that knows the locus")
        omega = angular_velocity(
            states.phi, states.psi, states.phi_dot / T, states.psi_dot / T, states.theta_dot / T
        )
        # near the flat state the two rates are huge and opposite: of their sum nothing is left
        tilt = 2.0 * np.sin(states.phi / 2.0) ** 2
        omega[:, 2] = (states.spin - states.theta_dot * tilt) / T
        aloft = np.zeros_like(states.x) if states.gap is None else states.gap
        point = np.stack((states.x, states.y, aloft), axis=-1) * can.radius
        weight = can.mass * self.scene.gravity
        offset = contact_offset(can, states.phi, states.psi, arc=arc_of(self.scene.effects))
        velocity = np.cross(offset, omega)
        if states.slip is not None:
            velocity[:, :2] += states.slip * can.radius / T
        yields = self.scene.effects.compliance is not None
        touches = np.ones(len(times), dtype=np.int64)
        forces = contact_force_in_world(states, self.solution.problem.parameters)
        lowest = point - offset
        if states.gap is not None and states.rise is not None:
            velocity[:, 2] += states.rise * can.radius / T
            touches[~(forces[:, 2] > 0.0) if yields else states.gap > 0.0] = 0
        return Trajectory(
            time=times,
            position=lowest,
            quaternion=quaternion(states.phi, states.psi, states.theta),
            velocity=velocity,
            angular_velocity=omega,
            contact_point=point,
            contact_force=weight * forces,
            penetration=np.maximum(-point[:, 2], 0.0),
            contact_count=touches,
        )


SOLVED: OrderedDict[tuple[Scene, Problem, str], Truth] = OrderedDict()
"""The last motions by scene, problem and the model that "auto" means, the oldest first."""


def solve_case(case: Case, seconds: float | None = None, *, again: bool = True) -> Truth:
    """Return the exact motion of a case's scene, up to its own horizon or for so many seconds.

    It is solved even if it was before, so that it can be timed, unless `again` is false.

    Raises
    ------
    InvalidSettingError
        If the case asks for a model, method or tolerance that does not exist, for a model that is
        too small for its scene, or is released inside the plane.
    """
    if case.scene.release.height < 0.0:
        allowed = "zero, on the rim, or greater"
        raise InvalidSettingError("release.height", case.scene.release.height, allowed)
    chosen = resolve(case, SETTINGS, 0.0)
    posed = problem(case.scene, seconds)
    model, rtol = str(chosen["model"]), float(chosen["rtol"])  # type: ignore[arg-type]
    method = str(chosen["method"])
    if method in RENAMED_METHODS:
        warn_renamed(renamed_method(method), RenamedValueWarning)
        method = RENAMED_METHODS[method]
    for name, value, known_words in (
        ("model", model, MODELS),
        ("method", method, ("auto", *METHODS)),
    ):
        if value not in known_words:
            raise InvalidSettingError(name, value, ", ".join(known_words))
    if not 0.0 < rtol < 1.0:
        raise InvalidSettingError("rtol", rtol, "greater than 0 and less than 1")
    if model != "auto" and not carries(model, posed):
        needed = smallest(posed)
        allowed = f"{needed.model}, the smallest that carries the scene, or larger. {needed.why}"
        raise InvalidSettingError("model", model, allowed)
    plain = dict(case.options).keys() <= {"model"}
    key = case.scene, posed, _meant(model, posed)
    known = SOLVED.get(key) if plain and not again else None
    if known is not None:
        return known
    try:
        solution = solve(
            posed,
            model=model,
            rtol=rtol,
            outputs=frozenset(() if model in WITHOUT_LOCUS else ("contact_locus",)),
            method="half-period" if method == "auto" else method,
        )
    except SolverError as error:  # what is left: a method that the model does not know
        allowed = f"auto or half-period: {error}"
        raise InvalidSettingError("method", method, allowed) from error
    motion = Truth(scene=case.scene, solution=solution)
    if plain:
        _remember(key, motion)
    return motion


def _remember(key: tuple[Scene, Problem, str], motion: Truth) -> None:
    """Store a motion in memory, and let the oldest go."""
    SOLVED[key] = motion
    while len(SOLVED) > MOST:
        SOLVED.popitem(last=False)


def exact_motion(scene: Scene) -> Truth:
    """Return the exact motion of a scene, by the closed formula where it is confirmed."""
    return solve_case(Case(scene=scene, engine="reference"), again=False)


@lru_cache(maxsize=SCENES)
def truth(scene: Scene, seconds: float | None = None) -> Truth:
    """Return the exact motion of a scene, by the smallest model that carries it, and keep it.

    Where the rim rolls it is the integration that confirms the closed motion, or what is left where
    the two do not agree (`reference.analysis.confirmation`).
    """
    needed = smallest(problem(scene, seconds)).model
    motion = _by(needed if needed != "rolling" else "auto", scene, seconds)
    if motion.solution.model != "exact":
        return motion
    # not the exact formula, which has to be inverted for the state at an instant
    integrated = _by(needed, scene, seconds).solution
    return Truth(scene=scene, solution=replace(integrated, agreement=motion.solution.agreement))


def exact_end(scene: Scene) -> float:
    """Return when the exact motion of a scene ends, s, by its model alone: nothing confirms it."""
    return _by(smallest(problem(scene, None)).model, scene, None).ends


def _by(model: str, scene: Scene, seconds: float | None) -> Truth:
    case = Case(scene=scene, engine="reference", options=(("model", model),))
    return solve_case(case, seconds, again=False)


@lru_cache(maxsize=SCENES)
def sample_truth(motion: Truth) -> Trajectory:
    """Return an exact motion on its own grid, and keep it: each case of a scene is held to it."""
    return motion.at(motion.grid())


def cancelled(motion: Truth) -> float:
    """Return the share of the force on phi that cancellation takes at the extrema of a motion."""
    solution = motion.solution
    if solution.model != "rolling":
        return 0.0
    extrema = solution.at(np.concatenate([solution.maxima, solution.minima]))
    return float(lost_of_force(extrema, solution.problem).max(initial=0.0))


def difference(one: Truth, other: Truth) -> float:
    """Return the largest relative difference of the bounces that two exact motions share."""
    return max(differences(one.solution, other.solution).values(), default=0.0)


def perturb(motion: Truth, share: float) -> Iterator[tuple[Truth, ...]]:
    """Yield for each number of a motion's problem the motions with that number changed a little.

    Parameters
    ----------
    motion : Truth
    share : float
        Relative change.
    """
    solution = motion.solution
    outputs = frozenset(() if solution.model in WITHOUT_LOCUS else ("contact_locus",))
    for problems in neighbours(solution.problem, share):
        yield tuple(
            Truth(scene=motion.scene, solution=solve(one, model=solution.model, outputs=outputs))
            for one in problems
        )
