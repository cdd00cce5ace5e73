"""How hard the solver of an engine worked, counted outside of any timed run.

Engines tell the iterations of a step, but not of a step that is taken in a batch. So the world is
put where the run was at some instants, steps three times there, and the third step, whose solver
starts from the forces of the second, is counted. An instant stands for the steps around it.
"""

import numpy as np

from harness.engines.base import World
from harness.engines.horizon import natural_time
from harness.engines.registry import engine
from harness.engines.schedule import SMALLEST_SHARE, Adaptive
from harness.engines.variants import counted_step
from harness.simulation import Simulation
from harness.trajectory import Trajectory
from models.state import Pose, Twist

_INSTANTS = 100
"""Over a run: the mean is known to a tenth of its spread."""

_STEPS = 3
"""The third step in a row starts from the forces of one that started from forces."""


def iterations(simulation: Simulation) -> float | None:
    """Return the mean iterations of the solver in a step, or None if the engine cannot tell."""
    case, trajectory = simulation.case, simulation.trajectory
    count = counted_step(case.engine)
    chosen = engine(case.engine)
    opens = getattr(chosen, "open", None)
    if count is None or opens is None or trajectory is None or len(trajectory) < _STEPS:
        return None
    world = opens(case)
    places = np.unique(np.linspace(0, len(trajectory) - 2, _INSTANTS).astype(np.int64))
    steps = np.array([_timestep(simulation, trajectory, place) for place in places.tolist()])
    gaps = np.diff(trajectory.time)[places]
    found = np.empty(len(places))
    for number, place in enumerate(places.tolist()):
        if hasattr(world, "set_timestep"):
            world.set_timestep(float(steps[number]))
        found[number] = _counted(world, trajectory, place, count)
    weight = gaps / steps
    return float(np.sum(weight * found) / np.sum(weight))


def _counted(world: World, trajectory: Trajectory, place: int, count: object) -> int:
    """Return the iterations of the third step from an instant on."""
    world.place(
        Pose(position=trajectory.position[place], quaternion=trajectory.quaternion[place]),
        Twist(
            velocity=trajectory.velocity[place],
            angular_velocity=trajectory.angular_velocity[place],
        ),
    )
    found = 0
    for _ in range(_STEPS):
        found = count(world)  # type: ignore[operator]
    return found


def _timestep(simulation: Simulation, trajectory: Trajectory, place: int) -> float:
    """Return the timestep in force at an instant, s."""
    case, fixed = simulation.case, simulation.timestep
    if fixed is None:
        raise ValueError("a solver that chooses its own steps has no iterations to count")
    if case.profile != "adaptive":
        return fixed
    natural = natural_time(case.scene)
    stage = Adaptive(
        case.scene.can,
        largest=fixed,
        smallest=SMALLEST_SHARE * natural,
        limit=natural,
        eta=float(simulation.settings["eta"]),  # type: ignore[arg-type]
        unit=natural,
    ).next(trajectory.quaternion[place].tolist(), trajectory.angular_velocity[place].tolist())
    return fixed if stage is None else stage.timestep
