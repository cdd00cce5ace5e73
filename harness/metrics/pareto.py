"""The Pareto front: what nothing else beats in both cost and error."""

import math
from collections.abc import Sequence


def pareto_front(costs: Sequence[float], errors: Sequence[float]) -> tuple[int, ...]:
    """Return the places of the points that no other point beats, by rising cost.

    A point is beaten by one that costs no more and errs no more, and less in one of the two. Points
    equal in both are all on the front or all off it.

    Parameters
    ----------
    costs, errors : sequence of float, length n
        What is no number, or infinite, is on no front.

    Returns
    -------
    tuple of int
    """
    usable = [
        place
        for place, (cost, error) in enumerate(zip(costs, errors, strict=True))
        if math.isfinite(cost) and math.isfinite(error)
    ]
    front: list[int] = []
    for place in sorted(usable, key=lambda place: (costs[place], errors[place])):
        if front:
            last = front[-1]
            equal = costs[place] == costs[last] and errors[place] == errors[last]
            if not equal and errors[place] >= errors[last]:
                continue
        front.append(place)
    return tuple(front)
