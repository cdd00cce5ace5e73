"""A continuous plant of a scene that can be placed, advanced and read.

The integrator goes on from a copy of the state of its own, so that a state that is set through the
context is not seen: a new simulator begins at each that is placed. Drake's contact results are the
spring's law at a state, and not what was solved between two: the force is read off the change of
the momentum, as a mean over each step.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import EventStatus

from harness.engines import Case, Contact, Floats, Value
from harness.engines.drake.cenic.settings import OF_THE_INTEGRATOR
from harness.engines.drake.plant import CanPlant, PlantWorld, state_of, unit
from models import Pose, Twist, to_body
from models.gravity import gravity_vector
from models.mass import body as body_of

_LIGHT = 1e-3
"""Of the weight: what bears less counts as no contact."""


class CenicWorld(PlantWorld):
    """One can on one ground in Drake, by steps that the integrator chooses.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    interval : float
        s; what `step` advances by.
    """

    def __init__(self, case: Case, chosen: Mapping[str, Value], interval: float) -> None:
        material = {name: chosen[name] for name in ("point_stiffness", "hunt_crossley_dissipation")}
        config = {"time_step": 0.0, "stiction_tolerance": chosen["stiction_tolerance"]}
        self.of, self._read = (
            CanPlant(case.scene, config, material, str(chosen["ground"])) for _ in range(2)
        )
        self._config = SimulatorConfig(
            integration_scheme="cenic", **{name: chosen[name] for name in OF_THE_INTEGRATOR}
        )
        self._interval, self._gravity = interval, gravity_vector(case.scene)
        self._solid = body_of(case.scene)
        self._light = _LIGHT * max(case.scene.gravity, 1.0)
        self._times: list[float] = []
        self._states: list[Floats] = []
        self._most, self.broken = math.inf, False
        self._start()

    def _start(self) -> None:
        """Begin anew at the state of the plant, at the time zero."""
        self.broken = False
        self.of.root.SetTime(0.0)
        self._simulator = Simulator(self.of.diagram, self.of.root)
        ApplySimulatorConfig(self._config, self._simulator)
        self._simulator.set_monitor(self._seen)
        self._times, self._states, self._most = [0.0], [self.of.state()], math.inf
        self._simulator.Initialize()

    def _seen(self, root: object) -> EventStatus:
        """Keep the state after a step of the integrator; end the call after so many."""
        del root  # whose plant is `self.of`
        time = float(self.of.root.get_time())
        if time > self._times[-1]:
            self._times.append(time)
            self._states.append(self.of.state())
        if len(self._times) > self._most:
            return EventStatus.ReachedTermination(self.of.diagram, "as many steps as asked for")
        return EventStatus.DidNothing()

    @property
    def timestep(self) -> float:
        """What `step` advances by, s; the steps within are the integrator's."""
        return self._interval

    def set_timestep(self, timestep: float) -> None:
        """Advance by another length from now on."""
        self._interval = timestep

    def place(self, pose: Pose, twist: Twist) -> None:
        """Put the can somewhere, moving, at the time zero."""
        self.of.set_state(state_of(pose, twist))
        self._start()

    def step(self) -> None:
        """Advance by one interval."""
        self._forget()
        self._advance(self._times[-1] + self._interval, math.inf)

    def advance(self, until: float, most: int) -> "Steps":
        """Take so many steps of the integrator or more, and none past a time in s.

        Returns
        -------
        Steps
            The state after the last of them is the first of the next.
        """
        self._forget()
        self._advance(until, most)
        ended = self.broken or self._times[-1] >= until
        times, states = np.array(self._times), np.array(self._states)
        forces = self._forces(times, states)
        if ended:  # the state at the end is handed over, too, with the force of the step to it
            forces = np.vstack((forces, forces[-1:] if len(forces) else np.zeros((1, 3))))
        kept = slice(None if ended else -1)
        return Steps(times=times[kept], states=states[kept], forces=forces, ended=ended)

    def _forget(self) -> None:
        """Forget all states but the last."""
        del self._times[:-1], self._states[:-1]

    def _advance(self, until: float, most: float) -> None:
        """Advance up to a time, s, or by so many steps."""
        self._most = most
        try:
            self._simulator.AdvanceTo(until)
        except RuntimeError:  # no step is short enough: numbers that break
            self.broken = True

    def _forces(self, times: Floats, states: Floats) -> Floats:
        """Return the mean force of the ground in each step between states, N, shape (n - 1, 3)."""
        moved = states[:, 10:]
        if self._solid.centre.any():
            R_WB = np.array([to_body(unit(state[:4]), np.eye(3)) for state in states])
            moved = moved + np.cross(states[:, 7:10], R_WB @ self._solid.centre)
        gained = np.diff(moved, axis=0) / np.diff(times)[:, None] - self._gravity
        gained[gained[:, 2] < self._light] = 0.0
        forces: Floats = self._solid.mass * gained
        return forces

    def pose(self) -> Pose:
        """Return where the can is.

        Raises
        ------
        InvalidValueError
            If the numbers break.
        """
        if self.broken:
            return Pose(position=np.full(3, math.nan), quaternion=np.full(4, math.nan))
        return super().pose()

    def contact(self) -> Contact:
        """Return the contact of the last interval: the state before it, and the mean force."""
        ends = [0, -1]
        times, states = np.array(self._times)[ends], np.array(self._states)[ends]
        return self.touch(states[0], self._forces(times, states)[0])

    def touch(self, state: Floats, force: Floats) -> Contact:
        """Return where the can touches in a state, given the force."""
        bears = bool(force[2] > 0.0)
        self._read.set_state(state)
        distance, point = self._read.lowest() if bears else (math.nan, np.full(3, math.nan))
        return Contact(point=point, force=force, penetration=-distance, count=int(bears))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Steps:
    """Steps that the integrator took.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Before each step, s; at the end of a run also after the last.
    states : ndarray, shape (n, 13)
    forces : ndarray, shape (n, 3)
        Mean force of the ground on the can in each step, N.
    ended : bool
        Whether the time is up, or the numbers broke.
    """

    times: Floats
    states: Floats
    forces: Floats
    ended: bool
