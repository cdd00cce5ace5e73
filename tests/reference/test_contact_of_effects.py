"""Place, velocity and energy of a can with effects, each against an independent route.

Places are of the body turned by SciPy's rotations, its lowest point found by a search; velocities
are differences of places along a motion; the energy is that of one rigid body about the common
centre of mass (`reference.equations.newton_euler`), where `reference.equations.energy` takes two
bodies.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

from reference import (
    PAPER_CAN,
    EffectError,
    Effects,
    Gravity,
    Mass,
    Problem,
    RefusedError,
    Solution,
    States,
    solve,
)
from reference.equations.contact_laws import Mode
from reference.equations.energy import energy
from reference.equations.newton_euler import GeneralEquations
from reference.equations.reaction_force import (
    centre_from_middle,
    centre_position,
    centre_velocity,
    contact_force,
    contact_force_in_world,
    contact_from_centre,
    contact_from_middle,
    friction_ratio,
    locus_velocity,
)
from reference.nonsmooth.segments import SegmentsPath
from reference.problem.states import initial_states

MASS = Mass(share=0.2, x=0.4, y=-0.3, z=0.5)
TILT = Gravity(constant=(0.05 * 0.6, 0.05 * 0.8, -math.sqrt(1 - 0.05**2)))
RELEASE = Problem(parameters=PAPER_CAN, phi=0.4, psi=0.3, theta=-0.8, psi_dot=0.2, duration=3.0)
EFFECTS = [
    Effects(rim=0.3),
    Effects(mass=MASS),
    Effects(mu=0.2),
    Effects(gravity=TILT),
    Effects(mu=0.2, rim=0.1, mass=MASS, gravity=TILT),
]


def motion(effects: Effects) -> Solution:
    slip = (0.0, 0.0) if effects.mu is None else (0.3, -0.2)
    found = replace(RELEASE, effects=effects, slip=slip)
    return solve(found, model="general", outputs={"contact_locus"})


def attitude(states: States) -> Rotation:
    """Return how the can is turned: it precesses, leans and rotates."""
    angles = np.stack([states.psi, -states.phi, states.theta], axis=-1)
    return Rotation.from_euler("ZYZ", angles)


@pytest.mark.parametrize("rim", [0.0, 0.05, 0.3, 1.0])
@pytest.mark.parametrize("phi", [1e-3, 0.4, 1.3])
def test_the_contact_is_the_lowest_point_of_the_rim(rim: float, phi: float) -> None:
    """A sphere of the radius of the arc, carried round by its centre, sweeps the rim out."""
    states = initial_states(replace(RELEASE, phi=phi))
    turn, h = attitude(states), PAPER_CAN.h

    def centre(angle: float) -> np.ndarray:
        ring = [(1 - rim) * math.cos(angle), (1 - rim) * math.sin(angle), rim - h]
        return np.asarray(turn.apply(ring)[0])

    # round the side that is down: theta turns the can's own axes away from it
    down = math.pi + 0.8
    found = minimize_scalar(
        lambda angle: centre(angle)[2], bounds=(down - 1, down + 1), options={"xatol": 1e-12}
    )
    lowest = centre(found.x) - np.array([0.0, 0.0, rim])
    arm = contact_from_middle(states, PAPER_CAN, Effects(rim=rim))[0]
    assert arm[2] == pytest.approx(lowest[2], abs=1e-14)
    # the height is a minimum, so its angle is known to the root of a rounding over its curvature
    assert arm == pytest.approx(lowest, abs=math.sqrt(2e-15 / phi))


@pytest.mark.parametrize("effects", EFFECTS, ids=lambda effects: "+".join(effects.declared()))
def test_the_centre_of_mass_is_that_of_two_bodies(effects: Effects) -> None:
    states = motion(effects).at(np.linspace(0.0, 3.0, 20))
    expected = np.zeros((20, 3))
    if effects.mass is not None:
        place = np.array([effects.mass.x, effects.mass.y, effects.mass.z])
        expected = attitude(states).apply(place) * effects.mass.share / (1 + effects.mass.share)
    assert centre_from_middle(states, effects) == pytest.approx(expected, abs=1e-15)
    apart = contact_from_middle(states, PAPER_CAN, effects) - expected
    assert contact_from_centre(states, PAPER_CAN, effects) == pytest.approx(apart, abs=1e-14)


@pytest.mark.parametrize("effects", EFFECTS, ids=lambda effects: "+".join(effects.declared()))
def test_velocities_are_the_rates_of_places(effects: Effects) -> None:
    found, step = motion(effects), 1e-5
    times = np.linspace(0.02, 0.98, 40) * found.t_end
    before, now, after = (found.at(times + shift) for shift in (-step, 0.0, step))
    places = [centre_position(states, PAPER_CAN, effects) for states in (before, after)]
    rates = (places[1] - places[0]) / (2 * step)
    # differences of second order, their third derivative at most 1e3; round-off gives 1e-11
    assert np.abs(rates - centre_velocity(now, PAPER_CAN, effects)).max() < 1e-7
    assert before.x is not None
    assert before.y is not None
    assert after.x is not None
    assert after.y is not None
    locus = np.stack([after.x - before.x, after.y - before.y], axis=-1) / (2 * step)
    assert np.abs(locus - locus_velocity(now, effects)).max() < 1e-7


@pytest.mark.parametrize("effects", EFFECTS, ids=lambda effects: "+".join(effects.declared()))
def test_the_energy_is_that_of_one_rigid_body(effects: Effects) -> None:
    found, times = motion(effects), np.linspace(0.0, 3.0, 50)
    assert isinstance(found.path, SegmentsPath)
    times = times[times <= found.t_end]
    rows, _ = found.path.rows(times)
    equations = GeneralEquations(parameters=PAPER_CAN, effects=effects)
    expected = equations.energy(rows, Mode(slips=effects.mu is not None))
    seen = energy(found.at(times), PAPER_CAN, effects)
    # terms of size 3, some twenty roundings each
    assert np.abs(seen - expected).max() < 1e-13
    assert np.ptp(seen + found.lost(times)) < 1e-12


@pytest.mark.parametrize("told", [centre_position, centre_velocity, contact_from_centre, energy])
def test_states_of_effects_without_their_effects_are_refused(told: object) -> None:
    """Nothing is left out silently."""
    states = motion(Effects(rim=0.3)).at(0.5)
    assert callable(told)
    release = initial_states(replace(RELEASE, effects=Effects(rim=0.3)))
    for asked in (
        lambda: told(states, PAPER_CAN),
        lambda: locus_velocity(states),
        lambda: energy(release, PAPER_CAN),
    ):
        with pytest.raises(EffectError) as refused:
            asked()
        assert refused.value.key == "effects"


def test_a_tilted_plane_has_no_potential_without_a_place() -> None:
    states = solve(replace(RELEASE, effects=Effects(gravity=TILT))).at(0.5)
    with pytest.raises(RefusedError) as refused:
        energy(states, PAPER_CAN, Effects(gravity=TILT))
    assert (refused.value.key, refused.value.allowed) == ("outputs", "contact_locus")


def test_the_force_that_states_bring_is_the_force() -> None:
    states = motion(EFFECTS[-1]).at(np.linspace(0.1, 2.9, 20))
    ahead, aside, normal = contact_force(states, PAPER_CAN)
    world = contact_force_in_world(states, PAPER_CAN)
    along = np.cos(states.psi) * world[:, 0] + np.sin(states.psi) * world[:, 1]
    assert ahead == pytest.approx(along, abs=1e-14)
    assert np.hypot(ahead, aside) / normal == pytest.approx(friction_ratio(states, PAPER_CAN))
