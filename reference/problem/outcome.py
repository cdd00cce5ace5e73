"""Outcomes of a motion."""

from enum import Enum


class Outcome(Enum):
    """Outcome of a solution; the value is a sentence for a person."""

    FINISHED = "The solution reached the horizon it was asked for."
    OVERTURNED = "The can overturned: its side, or its other rim, meets the plane."
    FELL_FLAT = "The can fell flat: the whole rim met the plane at once."
    CAME_TO_REST = (
        "The can came to rest in finite time: it lies flat on the plane, and if it moves at all it "
        "turns about the normal."
    )
    STEADY = (
        "The can rolls steadily or stands balanced: phi does not oscillate, so it never bounces."
    )
    NO_BOUNCE = "The can did not bounce: phi ran on without the next maximum."
    LIFTED = "The plane would have to pull: the can leaves it, and rolling on it ends."
    INCONSISTENT = (
        "No motion of a rigid can satisfies the law of friction here: it is inconsistent "
        "(Painleve's paradox), and a real contact would answer with a jolt."
    )
    INDETERMINATE = (
        "Several motions of a rigid can satisfy the law of friction here: which follows is "
        "indeterminate (Painleve's paradox)."
    )
    JAMMED = (
        "The contact jams: under its friction its mobility along the normal falls to zero, where "
        "the force of the plane has no bound (dynamic jamming, in Painleve's paradox)."
    )
    OUTWORKED = (
        "The motion calls for more than 200000 evaluations of its equations: it is not followed "
        "further."
    )
    VIBRATES = (
        "The contact vibrates: its impacts and vibrations call for more than 200000 evaluations of "
        "the equations, and the motion is not followed further."
    )
    STALLED = "The integrator could not advance: the step fell below what a double resolves."
    UNRESOLVED = (
        "Round-off decides how this motion goes on: no method can be trusted here, so no bounce "
        "is given."
    )


UNFINISHED = frozenset({Outcome.OUTWORKED, Outcome.VIBRATES})
"""Outcomes of a motion that goes on, and calls for too much work."""
