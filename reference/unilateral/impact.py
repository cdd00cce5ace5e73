"""A rigid impact at one point of the rim, with friction: how it ends, and what it takes.

An impulse (P, p) of the plane, p along the normal, changes the velocity u of the material at the
contact by D (P, p), with the symmetric, positive definite mobility D of the point. Bodies do not
move during an impact, so that D is constant. Three laws say when the impact is over:

    newton     u_z after is -e u_z before (Newton, Principia, 1687; Kane and Levinson 1985)
    poisson    p is (1 + e) times its value at the greatest compression, where u_z = 0 (Routh 1905)
    energetic  the work of p during restitution is e^2 of that during compression (Stronge 1990)

Newton's law is of the whole impact, and so is its friction: |P| <= mu p, and where the rim still
slides at the end P = -mu p against its last slip. The other two follow the slip through the impact,

    du/dp = D (-mu u_t/|u_t|, 1)                                     (Darboux 1880, Keller 1986)

as `reference.unilateral.impact_process` does. Infinite friction is the limit of these laws.

Newton's law with friction may make energy (Kane's paradox); the energetic law never does, for
neither the normal impulse nor friction then works more than it takes. An impact whose law would
make energy, or has no answer inside the cone, is computed by the energetic law with the same e, and
says so; in which of the two cases, `made_energy` tells.
"""

from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin

import numpy as np

from reference.problem.states import Floats
from reference.unilateral.impact_process import ENERGETIC, NORMAL, aligned, followed, push

NEWTON = "newton"
# Energy that an impact makes by round-off, as a share of that of its velocities.
ROUNDED = 1e-13


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Collision:
    """An impact of one point, in units of the problem.

    Attributes
    ----------
    impulse : ndarray, shape (3,)
        Along the two level axes and the normal, in m sqrt(g R).
    velocity : ndarray, shape (3,)
        Of the material at the contact, after the impact.
    energy_lost : float
        In m g R.
    law : str
        "newton", "poisson" or "energetic".
    made_energy : bool
        Whether the declared law would have made energy, so that the energetic law took its place;
        it does so, too, where Newton's law has no answer, and where a rim jams.
    """

    impulse: Floats
    velocity: Floats
    energy_lost: float
    law: str
    made_energy: bool


def collide(
    D: Floats, u: Floats, mu: float, e: float, law: str, *, jams: bool = False
) -> Collision:
    """Return the outcome of an impact.

    Parameters
    ----------
    D : ndarray, shape (3, 3)
        Mobility of the contact: change of its velocity by a unit of impulse.
    u : ndarray, shape (3,)
        Velocity before; the third component is not positive.
    mu : float
        Coefficient of friction, infinite for a rim that never slips.
    e : float
        Coefficient of restitution, in [0, 1].
    law : str
        "newton" or "poisson".
    jams : bool
        Whether this is an impact without collision, of a sliding rim whose normal mobility has
        fallen to zero: its slip is followed until it stops, or the plane lets go. Newton's law says
        nothing of it, for its normal velocity is zero; the energetic law takes its place.
    """
    size = float(u @ np.linalg.solve(D, u))
    if jams and law == NEWTON:
        law = ENERGETIC
    answer, made = None, False
    for name in (law, ENERGETIC):
        newton = name == NEWTON
        answer = _newton(D, u, mu, e) if newton else followed(D, u, mu, e, name, jams=jams)
        if answer is None:
            continue
        impulse, after = answer
        lost = -float((u + after) @ impulse) / 2
        if lost >= -ROUNDED * size or name == ENERGETIC:
            break
        made = True
    assert answer is not None  # noqa: S101 - the energetic law always has one
    return Collision(
        impulse=impulse,
        velocity=after,
        energy_lost=max(lost, 0.0),
        law=name,
        made_energy=made,
    )


def _newton(D: Floats, u: Floats, mu: float, e: float) -> tuple[Floats, Floats] | None:
    """Return impulse and velocity after it of Newton's law; None where none is in the cone."""
    target = np.array([0.0, 0.0, -e * u[NORMAL]])
    impulse: Floats = np.asarray(np.linalg.solve(D, target - u))
    if impulse[NORMAL] >= 0 and hypot(*impulse[:2]) <= mu * impulse[NORMAL]:
        return impulse, target

    def outcome(angle: float) -> tuple[Floats, Floats]:
        way = push(mu, cos(angle), sin(angle))
        answer = D @ way
        impulse = way * (closing / answer[NORMAL])
        after = u + D @ impulse
        after[NORMAL] = target[NORMAL]
        return impulse, after

    closing = -(1 + e) * float(u[NORMAL])
    if mu == 0.0:
        return outcome(0.0)
    start = atan2(u[1], u[0])
    # of several answers the one in which the slip turns least
    angles, _ = aligned(D, u, mu, closing)
    turned = np.abs((angles - start + pi) % (2 * pi) - pi)
    return outcome(float(angles[np.argmin(turned)])) if angles.size else None
