"""Random cans with random effects that leave the plane and land: none fails, and none makes energy.

Forty run always, a hundred are slow, and a thousand have a command. Every law of the contact is
drawn beside restitution: finite and infinite friction, static above kinetic, a patch, drilling,
rolling resistance, contour friction, films of air.
"""

from math import cos, pi, sin

import numpy as np
import pytest

from reference import Effects, Gravity, Mass, Outcome, Parameters, Problem, Restitution, solve
from tests.support.unilateral_energy import energy

# Of the weight: what a force may fall short of zero by where a root of it is found.
ROUNDED = 1e-9
# Of the energy: what a film below a can that all but lies on its face leaves of it.
BALANCED = 1e-9
CAME_OUT = {
    Outcome.FINISHED,
    Outcome.OVERTURNED,
    Outcome.CAME_TO_REST,
    Outcome.FELL_FLAT,
    Outcome.INCONSISTENT,
    Outcome.INDETERMINATE,
    Outcome.JAMMED,
}


def drawn(seed: int) -> Problem:
    """Return a random problem with restitution."""
    numbers = np.random.default_rng(seed)

    def one(low: float, high: float) -> float:
        return float(numbers.uniform(low, high))

    def often(share: float) -> bool:
        return bool(numbers.random() < share)

    h, a = one(0.1, 2.0), one(0.3, 1.0)
    mu = (None, 0.0, one(0.02, 1.5), one(0.02, 1.5))[int(numbers.integers(4))]
    static = mu + one(0, 0.5) if mu is not None and often(0.25) else None
    patch = one(0, 0.2) * bool(mu and often(0.25))
    rolling = one(0, 0.05) * often(0.25)
    tilt, way = one(0.0, 0.2) * often(0.2), one(0, 2 * pi)
    down = (sin(tilt) * cos(way), sin(tilt) * sin(way), -cos(tilt))
    shakes = float(often(0.2))
    shaken = (shakes * one(-1, 1), shakes * one(-1, 1), shakes * one(-1, 1))
    mass = Mass(share=one(0.05, 0.5), x=one(-0.5, 0.5), y=one(-0.5, 0.5), z=one(-0.5, 0.5) * h)
    return Problem(
        parameters=Parameters(a=a, c=one(0.2, 1.2) * a, h=h),
        phi=one(0.05, 1.3),
        psi=one(0, 6),
        theta=one(0, 6),
        phi_dot=one(-0.8, 0.8),
        psi_dot=one(-1.5, 1.5),
        theta_dot=one(-1.5, 1.5),
        height=one(0.0, 1.0) * often(0.6),
        duration=3.0,
        effects=Effects(
            mu=mu,
            mu_static=static,
            patch=patch,
            drilling=one(0, 0.05) * bool(not patch and often(0.25)),
            rolling_resistance=rolling,
            contour=one(0, 0.05) * bool(not rolling and often(0.25) and mu != 0.0),
            contour_damping=one(0, 0.05) * often(0.2),
            film=one(0, 0.02) * often(0.15),
            boundary_layer=one(0, 0.02) * often(0.1),
            linear_damping=one(0, 0.1) * often(0.3),
            angular_damping=one(0, 0.1) * often(0.3),
            rim=one(0.01, 0.09) * often(0.2),
            gravity=Gravity(
                constant=down,
                amplitude=shaken,
                rate=one(1, 6),
                phase=one(0, 6),
            ),
            mass=mass if often(0.3) else None,
            restitution=Restitution(
                coefficient=(0.0, 1.0, one(0, 1))[int(numbers.integers(3))],
                law=("newton", "poisson")[int(numbers.integers(2))],
            ),
        ),
    )


def check(seed: int) -> None:
    """Solve a random problem and check what every motion must have."""
    problem = drawn(seed)
    solution = solve(problem, outputs=frozenset({"contact_locus"}))
    assert solution.outcome in CAME_OUT, (seed, solution.outcome)
    there = solution.at(np.linspace(0, solution.t_end, 200))
    assert there.force is not None
    assert there.gap is not None
    force = there.force[:, 2]
    if solution.outcome is Outcome.INCONSISTENT:
        # it ends with the force that there would have to be
        force = force[:-1] if solution.t_end > 0 else force[:0]
    assert force.min(initial=0.0) >= -ROUNDED, seed
    assert there.gap.min() >= 0, seed
    times = np.linspace(0, solution.t_end, 200)
    seen = energy(solution, times) + solution.lost(times)
    assert np.abs(seen - seen[0]).max() <= BALANCED * max(1.0, float(np.abs(seen).max())), seed
    assert np.isfinite(there.phi).all(), seed
    at = np.unique([impact.time for impact in solution.impacts if impact.time > 0])
    made = energy(solution, at) - energy(solution, np.nextafter(at, 0))
    assert made.max(initial=0.0) <= BALANCED * max(1.0, float(np.abs(seen).max())), seed
    assert all(impact.normal_impulse >= 0 for impact in solution.impacts), seed


@pytest.mark.parametrize("seed", range(40))
def test_a_random_scene_comes_out(seed: int) -> None:
    check(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1100, 1252, 1387, 1406, 1463, *range(1005, 2000, 10)])
def test_another_random_scene_comes_out(seed: int) -> None:
    check(seed)
