"""A discrete plant of a scene that can be placed, stepped and read.

The timestep is compiled into a plant: there is one for each that is asked for, and the state goes
from one to the next. What a step solves is evaluated at the state before it. Damping and the
shaking of the ground are a force on the can, constant in a step.
"""

import math
from collections.abc import Mapping

import numpy as np

from harness.engines import Case, Contact, Value, contact_of
from harness.engines.drake.plant import CanPlant, PlantWorld, state_of, unit
from harness.engines.drake.settings import OF_A_GEOMETRY, OF_THE_PLANT, is_hydroelastic
from models import Pose, Twist, to_body
from models.gravity import shaking
from models.mass import body as body_of

_NONE = contact_of(np.empty((0, 3)), np.empty((0, 3)), math.nan)
"""What a step solves that does not converge."""


class DrakeWorld(PlantWorld):
    """One can on one ground in Drake, by fixed steps.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    timestep : float
        s.
    """

    def __init__(self, case: Case, chosen: Mapping[str, Value], timestep: float) -> None:
        self._scene, self._solid, self._chosen = case.scene, body_of(case.scene), chosen
        effects = case.scene.effects
        self._pushed = effects.shake is not None or effects.damping is not None
        # a relaxation time of a timestep goes with it where nobody asks for another
        own = "relaxation_time" not in dict(case.options) and effects.compliance is None
        self._tied = own and case.profile != "default"
        self._time, self._broken, self._plants = 0.0, False, dict[float, CanPlant]()
        self._contact: Contact | None = None
        self.of = self._plant(timestep)

    def _plant(self, timestep: float) -> CanPlant:
        """Return the plant of a timestep, s."""
        if timestep not in self._plants:
            chosen = dict(self._chosen) | ({"relaxation_time": timestep} if self._tied else {})
            self._plants[timestep] = CanPlant(
                self._scene,
                {
                    "time_step": timestep,
                    **{name: chosen[name] for name in OF_THE_PLANT},
                },
                {name: chosen[name] for name in OF_A_GEOMETRY},
                str(chosen["ground"]),
                compliant=chosen if is_hydroelastic(chosen) else None,
                pushed=self._pushed,
            )
        return self._plants[timestep]

    @property
    def timestep(self) -> float:
        """The timestep of the plant, s."""
        return float(self.of.plant.time_step())

    def set_timestep(self, timestep: float) -> None:
        """Step by another length from now on: by another plant."""
        if timestep != self.timestep:
            state = self.of.state()
            self.of = self._plant(timestep)
            self.of.set_state(state)

    def place(self, pose: Pose, twist: Twist) -> None:
        """Put the can somewhere, moving, at the time zero."""
        self._time, self._broken = 0.0, False
        self.of.set_state(state_of(pose, twist))

    def step(self) -> None:
        """Advance by one timestep."""
        if self._pushed:
            self._push()
        try:
            update = self.of.diagram.EvalUniquePeriodicDiscreteUpdate(self.of.root)
        except RuntimeError:  # its solver does not converge: numbers that break
            self._broken, self._contact = True, _NONE
            return
        self._contact = self.of.contact()
        self.of.root.SetDiscreteState(update.value())
        self._time += self.timestep

    def _push(self) -> None:
        """Apply what shakes and damps the can in the coming step."""
        effects, solid, state = self._scene.effects, self._solid, self.of.state()
        force, torque = np.zeros(3), np.zeros(3)
        if effects.shake is not None:
            force = force + solid.mass * shaking(self._scene, self._time, self.timestep)
        if effects.damping is not None:
            R_WB, spin = to_body(unit(state[:4]), np.eye(3)), state[7:10]
            velocity = state[10:] + np.cross(spin, R_WB @ solid.centre)
            force = force - effects.damping.linear * solid.mass * velocity
            torque = -effects.damping.angular * (R_WB @ solid.inertia @ R_WB.T @ spin)
        self.of.push(force, torque, solid.centre)

    def pose(self) -> Pose:
        """Return where the can is.

        Raises
        ------
        InvalidValueError
            If the numbers break.
        """
        if self._broken:
            return Pose(position=np.full(3, math.nan), quaternion=np.full(4, math.nan))
        return super().pose()

    def contact(self) -> Contact:
        """Return the contact that the last step solved: that of the state before it."""
        if self._contact is None:
            raise RuntimeError("no step was taken")
        return self._contact
