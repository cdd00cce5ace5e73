"""The reference as an engine: the exact equations, in the harness's units and frames.

The one file of the harness that imports `reference`. A reference model moves a can like any engine
does, so it can be run, timed and compared like one; and as the truth it can be asked for its state
at any instant, so that an engine is compared on its own time grid.
"""

import time
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import version

import numpy as np

from harness.bounce import Bounce
from harness.case import Case
from harness.engines.base import Capabilities, Floats, Setting, resolve
from harness.engines.horizon import natural_time
from harness.engines.variants import Variant
from harness.errors import InvalidSettingError
from harness.simulation import Outcome, Simulation
from harness.trajectory import Trajectory
from models.kinematics import angular_velocity, quaternion
from models.rim import contact_offset, rolling_velocity
from models.scene import Scene
from reference import Outcome as Ending
from reference import Parameters, Problem, Solution, SolverError, solve
from reference.contact import contact_force_in_world

SETTINGS = (
    Setting(
        name="model",
        default="auto",
        matched="auto",
        meaning="Which equations; auto takes the smallest that carries the scene.",
    ),
    Setting(
        name="method",
        default="auto",
        matched="auto",
        meaning="How they are integrated; auto takes the model's own method.",
    ),
    Setting(
        name="rtol",
        default=1e-12,
        matched=1e-12,
        meaning="Relative tolerance of the integrator.",
    ),
)

_TOLERANCES = (1e-3, 1e-6, 1e-9, 1e-12)

WITHOUT_LOCUS = frozenset({"reduced", "asymptotic", "pendulum"})
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

    def grid(self) -> Floats:
        """Return sampling times that are dense by angle and hold every extremum of phi, s."""
        return self.solution.grid() * natural_time(self.scene)

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
        point = np.stack((states.x, states.y, np.zeros_like(states.x)), axis=-1) * can.radius
        weight = can.mass * self.scene.gravity
        return Trajectory(
            time=times,
            position=point - contact_offset(can, states.phi, states.psi),
            quaternion=quaternion(states.phi, states.psi, states.theta),
            velocity=rolling_velocity(can, states.phi, states.psi, omega),
            angular_velocity=omega,
            contact_point=point,
            contact_force=weight * contact_force_in_world(states, self.solution.problem.parameters),
            penetration=np.zeros(len(times)),
            contact_count=np.ones(len(times), dtype=np.int64),
        )


class ReferenceEngine:
    """The mathematics of the paper."""

    name = "reference"
    settings = SETTINGS
    variants = VARIANTS
    capabilities = Capabilities(honours=frozenset(), imposes={})

    @property
    def version(self) -> str:
        """The version of this package."""
        return version("rockingcan")

    def timestep(self, case: Case) -> None:
        """Return None: the solver chooses its own steps.

        Raises
        ------
        InvalidSettingError
            If the case asks for one.
        """
        if case.timestep is not None:
            raise InvalidSettingError(
                "timestep", case.timestep, "none at all: the reference chooses its own steps"
            )

    def simulate(self, case: Case) -> Simulation:
        """Solve a case to its horizon.

        Raises
        ------
        UnknownSettingError, InvalidSettingError
            If the case asks for a model or method that does not exist.
        """
        self.timestep(case)
        chosen = resolve(case, SETTINGS, 0.0)
        reason = refusal(case.scene)
        if reason:
            return Simulation(
                case=case,
                outcome=Outcome.NO_SOLUTION,
                note=reason,
                trajectory=None,
                engine_version=self.version,
                model=str(chosen["model"]),
                settings=chosen,
            )
        started, cpu = time.perf_counter(), time.process_time()
        found = solved(case)
        outcome, note = _ending(found.solution)
        trajectory = None
        if chosen["model"] in WITHOUT_LOCUS:
            note = f"{note} The model knows no contact locus: no motion to show.".lstrip()
        else:
            trajectory = sampled(found)
        return Simulation(
            case=case,
            outcome=outcome,
            note=note,
            trajectory=trajectory,
            engine_version=self.version,
            model=found.solution.model,
            settings=chosen,
            steps=found.solution.steps,
            wall_s=time.perf_counter() - started,
            cpu_s=time.process_time() - cpu,
        )


def refusal(scene: Scene) -> str:
    """Return in a sentence why a scene has no rolling motion; nothing if it has one."""
    if scene.gravity == 0.0:
        return "Without gravity nothing holds the can to the plane, so it does not roll."
    if scene.release.height > 0.0:
        return "The can is released above the plane, and rolling says nothing of its landing."
    if scene.release.height < 0.0:
        return "The can is released inside the plane, where no rigid can is."
    return ""


def solved(case: Case, seconds: float | None = None) -> Truth:
    """Return the exact motion of a case's scene, up to its own horizon or for so many seconds.

    Raises
    ------
    InvalidSettingError
        If the case asks for a model, method or tolerance that does not exist, or is not released
        on its rim.
    """
    if case.scene.release.height != 0.0:
        raise InvalidSettingError("release.height", case.scene.release.height, "zero: on the rim")
    scene, chosen = case.scene, resolve(case, SETTINGS, 0.0)
    T, can, release = natural_time(scene), scene.can, scene.release
    horizon = scene.horizon.seconds if seconds is None else seconds
    problem = Problem(
        parameters=Parameters(a=can.a, c=can.c, h=can.h),
        phi=release.phi,
        psi=release.psi,
        theta=release.theta,
        phi_dot=release.phi_dot * T,
        psi_dot=release.psi_dot * T,
        theta_dot=release.theta_dot * T,
        bounces=scene.horizon.bounces if horizon is None else None,
        duration=None if horizon is None else horizon / T,
    )
    choices = {name: chosen[name] for name in ("method",) if chosen[name] != "auto"}
    try:
        solution = solve(
            problem,
            model=str(chosen["model"]),
            rtol=float(chosen["rtol"]),  # type: ignore[arg-type]
            outputs=frozenset(() if chosen["model"] in WITHOUT_LOCUS else ("contact_locus",)),
            **choices,  # type: ignore[arg-type]
        )
    except SolverError as error:
        raise InvalidSettingError("model, method or rtol", dict(chosen), str(error)) from error
    return Truth(scene=scene, solution=solution)


@lru_cache(maxsize=64)
def truth(scene: Scene, seconds: float | None = None) -> Truth:
    """Return the exact motion of a scene, solved with the reference's own choices, and keep it."""
    # not the exact formula, which has to be inverted for the state at a given instant
    return solved(Case(scene=scene, engine="reference", options=(("model", "rolling"),)), seconds)


@lru_cache(maxsize=64)
def sampled(motion: Truth) -> Trajectory:
    """Return an exact motion on its own grid, and keep it: each case of a scene is held to it."""
    return motion.at(motion.grid())


def _ending(solution: Solution) -> tuple[Outcome, str]:
    """Return how a solution ended, in the harness's terms and in the reference's words."""
    if solution.outcome is Ending.FINISHED:
        return Outcome.FINISHED, ""
    if solution.outcome is Ending.OVERTURNED:
        return Outcome.OVERTURNED, solution.outcome.value
    return Outcome.NO_SOLUTION, solution.outcome.value
