"""Checks of an exact motion: whether a scene has one, its assumptions, and its divergence."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

from harness.core.errors import InvalidSettingError
from harness.engines.reference.to_reference_problem import problem, refusal
from harness.engines.reference.truth import SCENES, Truth, sample_truth, truth
from harness.engines.registry import missing_effects
from harness.engines.stepping.horizon import natural_time
from models.scene import Scene
from reference import PARTED, Finding, FindingKind, Guard, divergence, examine
from reference.problem.outcome import UNFINISHED


@dataclass(frozen=True, slots=True, kw_only=True)
class Divergence:
    """How releases part that differ by one part in 1e12.

    Parameters
    ----------
    growth : float
        Of the disturbance, over the whole motion.
    lyapunov_time : float
        s, in which it grows by e; infinite where it does not grow exponentially.
    parted : float
        When it has grown to 0.1 rad, s; foretold where that is beyond the motion, infinite if
        never.
    chaotic : bool
        Whether it grows so much that an engine's own error, as small as 1e-5, becomes as large as
        the motion: then what differs in the end is no error.
    """

    growth: float
    lyapunov_time: float
    parted: float
    chaotic: bool

    def decidable_until(self, error: float) -> float:
        """Return when an error of this size at the release has grown to 0.1 rad, s."""
        return self.lyapunov_time * max(math.log(PARTED / error), 0.0)


@lru_cache(maxsize=SCENES)
def check_assumptions(motion: Truth) -> Guard:
    """Return the extremes of the assumed quantities over an exact motion, in N, rad and m."""
    can, gravity = motion.scene.can, motion.scene.gravity
    guard = examine(motion.solution, sample_truth(motion).time / natural_time(motion.scene))
    weight = can.mass * gravity
    return replace(guard, normal_force=guard.normal_force * weight, gap=guard.gap * can.radius)


def findings(scene: Scene) -> tuple[Finding, ...]:
    """Return the assumptions that the exact motion of a scene breaks, or why it has none."""
    reason = refusal(scene)
    if reason:
        return (Finding(kind=FindingKind.REFUSED, sentence=reason),)
    return check_assumptions(truth(scene)).findings


def may_be_chaotic(scene: Scene) -> bool:
    """Whether a scene declares what makes motions chaotic.

    An axisymmetric can on a level plane at rest is integrable: its copies part, but no faster than
    time itself. With a point mass on its axis it is such a can, of another height.
    """
    point = scene.effects.point_mass
    off_axis = point is not None and (point.x != 0.0 or point.y != 0.0)
    return off_axis or bool({"shake", "tilt"} & set(scene.effects.declared()))


@lru_cache(maxsize=SCENES)
def divergence_of(scene: Scene) -> Divergence | None:
    """Return how disturbed releases part, of a scene that may be chaotic; None of any other.

    None, too, of one that calls for too much work to be followed at all, let alone five times, and
    of one that ends where it begins.
    """
    if refusal(scene) or not may_be_chaotic(scene):
        return None
    solution = truth(scene).solution
    ends = solution.outcome in UNFINISHED or solution.t_end == 0.0
    # of impacts, which part neighbours by their times, there are no equations of variation
    if ends or solution.problem.effects.restitution is not None:
        return None
    T, growing = natural_time(scene), divergence(problem(scene), solution)
    return Divergence(
        growth=growing.growth,
        lyapunov_time=T / growing.rate if growing.rate > 0.0 else math.inf,
        parted=growing.parted * T,
        chaotic=growing.chaotic,
    )


def check_exact(scene: Scene, *, chaotic: bool = False) -> None:
    """Refuse a scene of which no run has an error: the reference does not carry it, or it is chaos.

    Parameters
    ----------
    scene : Scene
    chaotic : bool
        Whether a chaotic scene is accepted.

    Raises
    ------
    InvalidSettingError
        Says which scenes have an exact motion.
    """
    if refusal(scene) or missing_effects("reference", scene):
        allowed = (
            "a scene under gravity with no effects but those that the reference carries: another "
            "has no exact motion"
        )
        raise InvalidSettingError("SCENE", scene.name, allowed)
    chaos = None if chaotic else divergence_of(scene)
    if chaos is not None and chaos.chaotic:
        allowed = (
            "a scene that is not chaotic: of another what differs in the end is no error, and "
            "`run` says when it parts"
        )
        raise InvalidSettingError("SCENE", scene.name, allowed)
