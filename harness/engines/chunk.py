"""A run comes in chunks of consecutive steps, raw until somebody wants to look at a state."""

from collections.abc import Callable
from dataclasses import dataclass

from harness.trajectory import Floats, Integers, Trajectory


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Chunk:
    """Consecutive steps: the states before each of them with the contacts that they solved.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Of the states before each step, s.
    quaternions : ndarray, shape (m, 4)
        Of the first m states, scalar first; fewer than n if the engine's numbers broke.
    constraint_rows : ndarray of int, shape (n,)
        Rows that each step solved for.
    sound : bool
        False if the engine's numbers broke within or right after these steps.
    read : callable
        Takes indices of the first m states and returns those states as a trajectory: most steps of
        a run are never looked at again.
    """

    times: Floats
    quaternions: Floats
    constraint_rows: Integers
    sound: bool
    read: Callable[[Integers], Trajectory]
