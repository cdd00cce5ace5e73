"""Friction, tilt, shaking and an off-centre mass: the integrator against scipy's DOP853.

Whole scenes, from the release to the horizon. The rival integrates in time, in plain numbers
(`tests.benchmarks.newton_euler`), finds where the rim begins to slip and where it sticks again by
the events of `solve_ivp`, and so the extrema of phi. Both are held against one truth, an
extrapolation in long double.

What they share: the rival and the truth have the same equations, which a test holds against
rotation matrices, and the first moments of a slip that begins from rest, in which it has no
direction that an explicit method could follow, are the integrator's own in both; of the truth they
are a tenth as long. So the error of a slip that begins leaves out what is wrong in these moments.

Of the tolerances of the rival, relative and absolute, that pair is compared which is fastest of
those as accurate as the integrator, or the most accurate where none is. The claim is against
DOP853 as scipy runs it, with a function of Python; the note tells the ratio against rates that
numba compiles, and where no tolerance is as accurate the time of the rival at an error of 1e-12.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import product
from math import cos, sin

import numpy as np
import scipy

from harness.engines.reference.to_reference_problem import problem as posed
from models.catalogue import load
from reference import Kind, Problem, Solution, solve
from reference.numerics.compiled import available
from tests.benchmarks.clock import Ratio, in_turns, seconds
from tests.benchmarks.extrapolation import Extrapolation
from tests.benchmarks.newton_euler import Event, Motion, Onset, follow

# From the least that scipy takes, a hundred roundings, upwards.
_RELATIVE = (3e-14, 1e-13, 1e-12, 1e-11)
# Of the relative tolerance, as angles and velocities of size 1 need it or more tightly.
_SHARES = (1.0, 0.1, 1e-3)
_TOLERANCES = tuple(product(_RELATIVE, _SHARES))
# An error at which the rival's time is told too, where it is less accurate than the integrator.
_PLAIN_ERROR = 1e-12
# Errors below this are those of the last digits of angles of size one.
_ROUNDINGS = 16 * float(np.finfo(float).eps)
# How long the first moments of a slip are, in sqrt(R/g), at most a tenth of it; and of the truth.
_BEGUN, _BEGUN_OF_TRUTH = 1e-2, 1e-3
# Speed of a slip, in sqrt(g R), from which it is brought to rest in one step; and of the truth.
_STOPPED, _STOPPED_OF_TRUTH = 1e-8, 1e-10
_REPEATS = 15
# Turns of a scene and the rival, and runs of each in its turn.
_TURNS, _RUNS = 5, 10
# How many times faster than DOP853 the integrator is to be, of every scene.
_FASTER = 10.0
# Strength, in units of the can, of laws that are declared for what they cost.
_WEAK = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Whole:
    """A scene of the catalogue.

    Attributes
    ----------
    scene : str
    what : str
        What the rim does in it.
    """

    scene: str
    what: str

    def problem(self) -> Problem:
        """Return the scene as a problem."""
        return posed(load(self.scene))


SCENES = (
    Whole(scene="slipping-rock", what="sticks, then slips"),
    Whole(scene="friction-below", what="sticks, slips and sticks"),
    Whole(scene="friction-above", what="sticks"),
    Whole(scene="rim-slips-all-round", what="slips"),
    Whole(scene="sliding-rim", what="slips"),
    Whole(scene="held-by-friction", what="sticks"),
    Whole(scene="rim-down-a-slope", what="sticks"),
    Whole(scene="tilted-plane", what="sticks"),
    Whole(scene="shaken-plane", what="sticks"),
    Whole(scene="off-centre-mass", what="sticks"),
    Whole(scene="chaotic-can", what="sticks"),
)


def friction_ratios() -> Iterator[Ratio]:
    """Measure the claims about friction, tilt and an off-centre mass, one by one."""
    yield from (_against_scipy(scene) for scene in SCENES)
    yield _without_what_is_not_declared()


def _without_what_is_not_declared() -> Ratio:
    """Time a scene of friction, and the same with laws that are too weak to move it."""
    scene = SCENES[0]
    plain = scene.problem()
    weak = replace(plain.effects, contour_damping=_WEAK, patch=_WEAK)
    laden = replace(plain, effects=weak)
    own, with_laws = in_turns(lambda: solve(plain), lambda: solve(laden), repeats=_REPEATS)
    ends = [_raw(solution, solution.t_end) for solution in (solve(plain), solve(laden))]
    apart = float(np.abs(ends[1] - ends[0]).max())
    return Ratio(
        what=f"{scene.scene} ({scene.what}) without laws that are not declared",
        ratio=with_laws / own,
        claim="at least 1.0 times as fast as with them",
        holds=with_laws >= own,
        first_s=own,
        second_s=with_laws,
        note=f"a patch and viscous contour friction of strength {_WEAK:g} move the end by "
        f"{apart:.1e}; without them the model is {solve(plain).model!r}",
    )


def _against_scipy(scene: Whole) -> Ratio:
    """Time a scene by the integrator, compiled where it can be, and by DOP853."""
    problem, compiled = scene.problem(), available()
    solution = solve(problem, compiled=compiled)
    end = solution.t_end
    truth = Extrapolation(problem)
    follow(truth, end, onsets(solution, _BEGUN_OF_TRUTH), stopped=_STOPPED_OF_TRUTH)
    exact = truth.y[[0, 1, 4, 5]]
    given = onsets(solution, _BEGUN)

    # an angle that turns through many radians has the round-off of its size
    size = np.maximum(np.abs(exact), 1.0)

    def error(y: np.ndarray) -> float:
        return float((np.abs(y[[0, 1, 4, 5]] - exact) / size).max())

    own_error = error(_raw(solution, end))
    rivals = [_Rival.of(problem, end, given, tolerances, error) for tolerances in _TOLERANCES]
    equal = [each for each in rivals if each.error <= max(own_error, _ROUNDINGS)]
    rival = min(equal, key=_seconds) if equal else min(rivals, key=_error)
    own, scipy_s = in_turns(
        lambda: solve(problem, compiled=compiled),
        partial(by_scipy, problem, end, rival.tolerances, given),
        repeats=_TURNS,
        runs=_RUNS,
    )
    note = f"error at the end, {end:.4g} sqrt(R/g), {own_error:.1e} against {rival.error:.1e}"
    if not equal:
        note += ", the best that it can"
        plain = [each for each in rivals if each.error <= _PLAIN_ERROR]
        if plain:
            note += (
                f"; {min(plain, key=_seconds).seconds / own:.3g} at an error of {_PLAIN_ERROR:g}"
            )
    if compiled:
        rates = partial(by_scipy, problem, end, rival.tolerances, given, compiled=True)
        rates()
        seconds_compiled = min(seconds(rates) for _ in range(_REPEATS))
        note += f"; {seconds_compiled / own:.3g} against rates compiled by numba"
    rtol, share = rival.tolerances
    claim = f"at least {_FASTER:g} times faster, and at least as accurate" if compiled else ""
    return Ratio(
        what=f"{scene.scene} ({scene.what}) against DOP853 at rtol {rtol:g}, atol {rtol * share:g}",
        ratio=scipy_s / own,
        claim=claim,
        holds=not compiled
        or (scipy_s >= _FASTER * own and own_error <= max(rival.error, _ROUNDINGS)),
        first_s=own,
        second_s=scipy_s,
        note=note,
    )


Tolerances = tuple[float, float]
"""Relative, and the absolute as a share of it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Rival:
    """DOP853 at its tolerances: the error that it makes, and the processor time that it takes."""

    tolerances: Tolerances
    error: float
    seconds: float

    @classmethod
    def of(
        cls,
        problem: Problem,
        end: float,
        given: list[Onset],
        tolerances: Tolerances,
        error: Callable[[np.ndarray], float],
    ) -> "_Rival":
        """Run it twice: what is compared is measured once more."""
        run = partial(by_scipy, problem, end, tolerances, given)
        taken = min(seconds(run) for _ in range(2))
        return cls(tolerances=tolerances, error=error(run()), seconds=taken)


def _seconds(rival: _Rival) -> float:
    return rival.seconds


def _error(rival: _Rival) -> float:
    return rival.error


@dataclass(frozen=True, slots=True, kw_only=True)
class SolvedOnset:
    """How a slip of a solution begins."""

    solution: Solution
    start: float
    end: float

    def gain(self, time: float) -> np.ndarray:
        """Return what the state gains from a time near the start to the end, shape (8,)."""
        before, after = _raw(self.solution, min(time, self.start)), _raw(self.solution, self.end)
        # what begins to slip was at rest
        before[6:] = 0.0
        return np.asarray(after - before)


def onsets(solution: Solution, duration: float) -> list[Onset]:
    """Return how each slip of a motion begins from rest, in its first moments."""
    return [
        SolvedOnset(
            solution=solution,
            start=phase.start,
            end=phase.start + min(duration, (phase.end - phase.start) / 10),
        )
        for phase in solution.phases
        if phase.kind is Kind.SLIP and (phase.start > 0 or solution.problem.slip == (0.0, 0.0))
    ]


def _raw(solution: Solution, time: float) -> np.ndarray:
    """Return the state of a solution as `Motion` has it, shape (8,)."""
    there = solution.at(time)
    phi, psi = float(there.phi[0]), float(there.psi[0])
    psi_dot = float(there.psi_dot[0])
    x, y = (0.0, 0.0) if there.slip is None else there.slip[0]
    slip = x * cos(psi) + y * sin(psi), y * cos(psi) - x * sin(psi)
    axial = psi_dot * cos(phi) + float(there.theta_dot[0])
    return np.array([phi, -there.phi_dot[0], psi_dot * sin(phi), axial, psi, there.theta[0], *slip])


class Dop853:
    """A motion integrated by scipy, with an event for each change of the law of contact.

    Attributes
    ----------
    motion : Motion
    time : float
    y : ndarray, shape (8,)
    slips : bool
    """

    def __init__(self, problem: Problem, tolerances: Tolerances, *, compiled: bool = False) -> None:
        self.motion = _motion_of(problem, compiled=compiled)
        self.time, self.y = 0.0, np.array(self.motion.released())
        self.slips = problem.slip != (0.0, 0.0)
        self._rtol, share = tolerances
        self._atol = self._rtol * share

    def integrate(self, end: float, event: Event | None) -> bool:
        """Integrate to a time, or to where a quantity falls to zero; return whether it did.

        Raises
        ------
        RuntimeError
            If scipy gives up.
        """
        field, slips = self.motion.field, self.slips

        def nutation_rate(_: float, y: np.ndarray) -> float:
            return float(y[1])

        # the extrema of phi are of the answer, with them the bounces
        watched: list[Callable[[float, np.ndarray], float]] = [nutation_rate]
        if event is not None:

            def change(t: float, y: np.ndarray) -> float:
                return float(event(t, tuple(y.tolist())))

            vars(change).update(terminal=True, direction=-1.0)
            watched.append(change)
        part = scipy.integrate.solve_ivp(
            lambda t, y: field(t, y, slips),
            (self.time, end),
            self.y,
            method="DOP853",
            rtol=self._rtol,
            atol=self._atol,
            events=watched,
        )
        if not part.success:
            raise RuntimeError(part.message)
        self.time, self.y = float(part.t[-1]), part.y[:, -1]
        return bool(part.status == 1)


# A problem's rates are compiled once, as those of the integrator are.
_motion_of = cache(Motion.of)


def by_scipy(
    problem: Problem,
    end: float,
    tolerances: Tolerances,
    onsets: list[Onset],
    *,
    compiled: bool = False,
) -> np.ndarray:
    """Return the state of a problem at a time, as `Motion` has it, by DOP853."""
    rival = Dop853(problem, tolerances, compiled=compiled)
    follow(rival, end, onsets, stopped=_STOPPED)
    return rival.y
