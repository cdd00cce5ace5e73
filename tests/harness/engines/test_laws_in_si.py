"""Laws of effects in SI units, written out as their pages have them, against the reference's.

The reference computes without dimensions; a factor of radius, mass or time that is lost between the
two changes a law by that factor, and no test of either side alone sees it.
"""

import math
from dataclasses import replace

import pytest

from harness.engines.reference.to_reference_problem import effects
from models import (
    AirFilm,
    Can,
    Compliance,
    ContourFriction,
    Drilling,
    Effects,
    RollingResistance,
    Slip,
    load,
)
from reference import Effects as Dimensionless

MASS, RADIUS, GRAVITY = 0.7, 0.23, 3.7
"""kg, m, m/s^2: units of which none is near one."""
TIME = math.sqrt(RADIUS / GRAVITY)
FORCE, MOMENT = MASS * GRAVITY, MASS * GRAVITY * RADIUS
ROUNDED = 1e-14
"""Relative: ten roundings of factors."""
RATE = 5.0
"""rad/s."""


def reference_of(declared: Effects) -> Dimensionless:
    """Return declared effects as the reference has them."""
    can = Can.from_groups(mass=MASS, radius=RADIUS, a=0.4, c=0.5, h=0.6)
    return effects(replace(load("gentle-rock"), can=can, gravity=GRAVITY, effects=declared))


def test_a_film_of_air_takes_moffatts_power() -> None:
    """Pi mu g R^2/phi^2 where theta'^2 = 4 g/(R phi), of a phi that is its own sine."""
    viscosity, phi = 0.31, 1e-6
    film = reference_of(Effects(air_film=AirFilm(viscosity=viscosity))).film
    theta_dot = math.sqrt(4.0 * GRAVITY / (RADIUS * phi))
    power = film * MOMENT * (theta_dot * TIME) / math.sin(phi) * theta_dot
    expected = math.pi * viscosity * GRAVITY * RADIUS**2 / phi**2
    # of a sine, in the square of phi
    assert power == pytest.approx(expected, rel=phi**2)


def test_boundary_layers_take_the_power_of_a_film_as_thick_as_they_are() -> None:
    viscosity, density = 0.31, 1.7
    layered = reference_of(Effects(air_film=AirFilm(viscosity=viscosity, density=density)))
    film = reference_of(Effects(air_film=AirFilm(viscosity=viscosity))).film
    thick = math.sqrt(viscosity / (density * RATE))
    assert layered.film == 0.0
    rate = RATE * TIME
    moment = layered.boundary_layer * math.sqrt(rate) * rate
    # a gap is R phi, so that a film as thick as the layer has this phi
    assert moment == pytest.approx(film * rate / (thick / RADIUS), rel=ROUNDED)


def test_contour_friction_has_its_force_and_its_arm() -> None:
    coulomb, viscous, load_of_rim = 0.02, 0.4, 1.3
    found = reference_of(
        Effects(contour_friction=ContourFriction(coulomb=coulomb, viscous=viscous))
    )
    dry = found.contour * (load_of_rim / FORCE) * MOMENT
    assert dry == pytest.approx(coulomb * load_of_rim * RADIUS, rel=ROUNDED)
    wet = found.contour_damping * (RATE * TIME) * MOMENT
    assert wet == pytest.approx(viscous * RADIUS**2 * RATE, rel=ROUNDED)


def test_arms_and_patches_are_lengths() -> None:
    arms = reference_of(Effects(slip=Slip(mu=0.3), drilling=Drilling(length=0.01)))
    assert arms.drilling * RADIUS == pytest.approx(0.01, rel=ROUNDED)
    rolls = reference_of(Effects(rolling_resistance=RollingResistance(length=0.02)))
    assert rolls.rolling_resistance * RADIUS == pytest.approx(0.02, rel=ROUNDED)
    patch = reference_of(Effects(slip=Slip(mu=0.3, patch=0.03))).patch
    assert patch * RADIUS == pytest.approx(0.03, rel=ROUNDED)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0])
def test_a_contact_that_gives_way_has_its_force(exponent: float) -> None:
    stiffness, damping, depth, speed = 3e3, 40.0, 0.002, 0.3
    law = Compliance(stiffness=stiffness, damping=damping, exponent=exponent)
    found = reference_of(Effects(compliance=law)).compliance
    assert found is not None
    d, rate = depth / RADIUS, speed * TIME / RADIUS
    if exponent == 1.0:
        ours, theirs = found.stiffness * d + found.damping * rate, stiffness * depth
        theirs += damping * speed
    else:
        ours = d**exponent * (found.stiffness + found.damping * rate)
        theirs = depth**exponent * (stiffness + damping * speed)
    assert ours * FORCE == pytest.approx(theirs, rel=ROUNDED)
