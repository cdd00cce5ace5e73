"""Laws that oppose the motion of the contact point along the rim, and the end they lead to.

The contact point runs along the rim with the velocity theta' (in R): theta is the rotation of the
can relative to the frame that precesses with the contact. Each law is a generalised force F on
theta, dimensionless:

    dry contour friction     F = -f N sign(theta')                   Le Saux, Leine and Glocker 2005
    viscous                  F = -d theta'                           Leine 2009
    film of air              F = -s theta'/sin(phi)                  Moffatt 2000
    boundary layers of air   F = -b |theta'|^(1/2) theta'            Bildsten 2002

A force on theta that does nothing in phi and psi is a moment m in the horizontal direction l1 =
(cos psi, sin psi, 0), along which the angular velocity has the component -sin(phi) theta':

    -m sin(phi) = F.

So it grows as 1/sin(phi), and leaves the angular momentum about the vertical alone.

Moffatt's dissipation in the film below a disk of radius R is pi mu g R^2/phi^2 where the precession
is that of steady rolling about a centre at rest, Omega^2 = 4 g/(R phi): as a law of the velocity,
(pi/4) mu R^3 Omega^2/phi. Air of the kinematic viscosity nu does not fill the gap with shear where
its boundary layer sqrt(nu/Omega) is thinner than the gap R phi: with that length in the place of
the gap the dissipation is (pi/4) mu R^4 Omega^2 sqrt(Omega/nu), of Bildsten's scaling, Omega^(5/2).
"""

import numpy as np

from reference.equations.state_vector import Angles
from reference.problem.effects import Effects
from reference.problem.states import Floats


def along_the_rim(effects: Effects) -> bool:
    """Return whether a law without a threshold opposes the motion along the rim."""
    return bool(effects.contour_damping or effects.film or effects.boundary_layer)


def moment_of_fluid(effects: Effects, rotation: Floats, at: Angles) -> Floats:
    """Return sin(phi) times the moment along l1 of the laws without a threshold.

    Parameters
    ----------
    effects : Effects
    rotation : ndarray, shape (n,)
        sin(phi) theta'; may be complex.
    at : Angles
        Of shape (n,).

    Returns
    -------
    ndarray, shape (n,)
        In m g R; times `rotation` it is the power that is lost, times sin(phi).
    """
    rate = rotation / at.S
    moment = effects.contour_damping * rate + effects.film * rate / at.S
    if effects.boundary_layer:
        moment = moment + effects.boundary_layer * rate * np.sqrt(_size(rate))
    return np.asarray(moment)


def _size(rate: Floats) -> Floats:
    """Return |rate|, analytic where it is not zero."""
    return np.where(rate.real < 0, -rate, rate)
