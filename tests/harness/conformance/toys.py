"""Adapters that break one clause of the contract each, and one that breaks none."""

import random
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from harness.core.case import Case
from harness.core.simulation import Outcome, Simulation
from harness.engines.base import Capabilities, Setting
from harness.engines.description import Description
from harness.engines.registry import engine
from models import Pose, Twist, to_body
from models.kinematics import to_world
from tests.support.engines import stepping_engine
from tests.support.trajectories import changed, path_of


class Toy:
    """MuJoCo behind an adapter that breaks one clause; its own clauses are MuJoCo's."""

    name = "toy"
    version = "1"
    description = Description()
    settings = engine("mujoco").settings
    capabilities = engine("mujoco").capabilities

    def timestep(self, case: Case) -> float | None:
        """Return the timestep of a case."""
        return engine("mujoco").timestep(case)

    def simulate(self, case: Case) -> Any:
        """Run a case and spoil it."""
        whole = engine("mujoco").simulate(replace(case, engine="mujoco"))
        return self.spoil(replace(whole, case=case, engine_version=self.version))

    def spoil(self, whole: Simulation) -> Any:
        """Return the answer, spoilt."""
        return whole


class Sound(Toy):
    """Breaks nothing."""


class WrongShape(Toy):
    """Hands over positions in the plane."""

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        return changed(whole, position=path_of(whole).position[:, :2])


class BackwardsInTime(Toy):
    """Lets time go back."""

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        return changed(whole, time=-path_of(whole).time)


class NotANumber(Toy):
    """Hands over what is no number."""

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        return changed(whole, velocity=np.full_like(path_of(whole).velocity, np.nan))


class RaisesOnDivergence(Toy):
    """Raises where an outcome is called for."""

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        if whole.outcome is not Outcome.FINISHED:
            raise FloatingPointError("the numbers exploded")
        return whole


class Random(Toy):
    """Throws dice."""

    dice = random.Random(1)  # noqa: S311 - no secret

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        return changed(whole, penetration=path_of(whole).penetration + self.dice.random() * 1e-12)


class Remembers(Toy):
    """Keeps something of the case before: the last mass it has seen."""

    mass: float | None = None

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        before, self.mass = self.mass or whole.case.scene.can.mass, whole.case.scene.can.mass
        return changed(whole, penetration=path_of(whole).penetration * (before / self.mass))


class Late(Toy):
    """Reads the contact of the next instant."""

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        if whole.trajectory is None:
            return whole
        both = (path_of(whole).contact_force, path_of(whole).contact_point)
        force, point = (np.concatenate((array[1:], array[-1:])) for array in both)
        return changed(whole, contact_force=force, contact_point=point)


class Falls(Toy):
    """Starts a millimetre above where it was released."""

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        return changed(whole, position=path_of(whole).position + np.array((0.0, 0.0, 1e-3)))


class Heavy(Toy):
    """Compiles a can with another moment, and falls accordingly."""

    def simulate(self, case: Case) -> Any:  # noqa: D102
        can = replace(case.scene.can, transverse_inertia=1.3 * case.scene.can.transverse_inertia)
        other = replace(case.scene, can=can)
        whole = engine("mujoco").simulate(replace(case, scene=other, engine="mujoco"))
        return replace(whole, case=case, engine_version=self.version)

    def open(self, case: Case) -> Any:  # noqa: D102
        can = replace(case.scene.can, transverse_inertia=1.3 * case.scene.can.transverse_inertia)
        return stepping_engine("mujoco").open(replace(case, scene=replace(case.scene, can=can)))


class Transposed(Toy):
    """Compiles a can, and hands spins to and fro in its frame, where they ought to be the world's.

    So does an adapter of an engine whose free joint has its spin in the body, if it misses that.
    """

    def open(self, case: Case) -> Any:  # noqa: D102
        return _TransposedWorld(stepping_engine("mujoco").open(case))


class _TransposedWorld:
    """A world whose spins in and out have the numbers that they have in the body."""

    def __init__(self, world: Any) -> None:
        self._world = world

    def __getattr__(self, name: str) -> Any:
        return getattr(self._world, name)

    def place(self, pose: Pose, twist: Twist) -> None:
        spin = to_world(pose.quaternion, twist.angular_velocity)
        self._world.place(pose, Twist(velocity=twist.velocity, angular_velocity=spin))

    def twist(self) -> Twist:
        twist, orientation = self._world.twist(), self._world.pose().quaternion
        spin = to_body(orientation, twist.angular_velocity)
        return Twist(velocity=twist.velocity, angular_velocity=spin)


class Single(Toy):
    """Keeps its state and its moments in single precision."""

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        names = ("position", "quaternion", "velocity", "angular_velocity")
        rounded = {name: in_single(getattr(path_of(whole), name)) for name in names}
        return changed(whole, **rounded)

    def open(self, case: Case) -> Any:  # noqa: D102
        world = stepping_engine("mujoco").open(case)
        return SimpleNamespace(mass=world.mass, inertia=in_single(world.inertia))


def in_single(numbers: np.ndarray) -> np.ndarray:
    """Return numbers rounded to single precision, as doubles."""
    return numbers.astype(np.float32).astype(np.float64)


class Sparse(Toy):
    """Records one sample in two hundred."""

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        from harness.core.trajectory import take  # noqa: PLC0415 - this toy alone

        if whole.trajectory is None or len(whole.trajectory) < 200:
            return whole
        return replace(
            whole, trajectory=take(whole.trajectory, np.arange(len(whole.trajectory))[::200])
        )


class Overshoots(Toy):
    """Runs past the horizon."""

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        return changed(whole, time=path_of(whole).time * 1.2)


class Ghost(Toy):
    """Points at a contact where there is none."""

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        return changed(whole, contact_point=np.nan_to_num(path_of(whole).contact_point))


class TakesAnything(Toy):
    """Takes every setting."""

    def simulate(self, case: Case) -> Any:  # noqa: D102
        return super().simulate(replace(case, options=()))


class Keeps(Toy):
    """Does not say which settings were in force."""

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        return replace(whole, settings={})


class Untidy(Toy):
    """Has a name for no command line, a setting twice, no version, and an odd effect."""

    name = "My Engine"
    version: Any = None
    settings = (*Toy.settings, Setting(name="cone", default=1, matched=1, meaning="Again."))
    capabilities = Capabilities(honours=frozenset({"magnetism"}), imposes={})


class Slippery(Toy):
    """Honours slip, and takes three times the friction."""

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        if whole.case.scene.effects.slip is None:
            return whole
        return changed(whole, contact_force=path_of(whole).contact_force * np.array((3, 3, 1)))


class Level(Toy):
    """Says that it honours a tilted plane, and runs a level one."""

    def simulate(self, case: Case) -> Any:
        """Run a case without its tilt."""
        effects = replace(case.scene.effects, tilt=None)
        level = replace(case, scene=replace(case.scene, effects=effects))
        return replace(super().simulate(level), case=case)


class Unpicklable(Toy):
    """Hands over what does not travel."""

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        return replace(
            whole, note=type("Words", (str,), {})("of a kind that only this adapter has")
        )


class Nervous(Toy):
    """Lets the horizon change the beginning."""

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        seconds = whole.case.scene.horizon.seconds or 0.0
        scale = np.array((0.0, seconds * 1e-9, 0.0))
        return changed(whole, position=path_of(whole).position + scale * (seconds > 0.03))


class Confuses(Toy):
    """Hands back a batch in another order."""

    def simulate_many(self, cases: list[Case]) -> list[Any]:  # noqa: D102
        return [self.simulate(case) for case in reversed(cases)]


class Cheerful(Toy):
    """Finishes, whatever the speed."""

    def spoil(self, whole: Simulation) -> Any:  # noqa: D102
        fine = whole.outcome is not Outcome.DIVERGED
        return whole if fine else replace(whole, outcome=Outcome.FINISHED)
