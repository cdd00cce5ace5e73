"""A run comes in chunks of consecutive steps, raw until somebody wants to look at a state."""

from collections.abc import Callable
from dataclasses import dataclass

from harness.trajectory import Floats, Integers, Trajectory


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Chunk:
    """Consecutive steps: the states before them with the contacts that they solved.

    An engine that pays for each reading may look at some of the steps only; each of those then
    stands for the steps up to the next.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Of the states that were read, each before its step, s.
    quaternions : ndarray, shape (m, 4)
        Of the first m states, scalar first; fewer than n if the engine's numbers broke.
    constraint_rows : ndarray of int, shape (n,)
        Rows that each of those steps solved for.
    sound : bool
        False if the engine's numbers broke within or right after these steps.
    read : callable
        Takes indices of the first m states and returns those states as a trajectory: most steps of
        a run are never looked at again.
    spans : ndarray of int, shape (n,), or None
        Steps that each reading stands for, its own the first; None where every step was read.
    """

    times: Floats
    quaternions: Floats
    constraint_rows: Integers
    sound: bool
    read: Callable[[Integers], Trajectory]
    spans: Integers | None = None
