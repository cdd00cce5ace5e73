"""The bound of the round-off of the energy, held against sixty digits at random places."""

import mpmath as mp
import numpy as np
import pytest

from reference import Parameters
from reference.equations.steady_motion import steady_rotation
from reference.integrable.cycle import released_potential
from reference.integrable.effective_potential import energy_noise, evaluate_potential
from reference.integrable.frobenius import can_constants, series_of
from tests.reference.hostile.truth import DIGITS, Potential

RELEASES, PLACES = 30, 30


def random_release(rng: np.random.Generator) -> tuple[Parameters, dict[str, float]]:
    """Return a can and a release, half of them on a steady motion, half of them with phi'."""
    a = 10.0 ** rng.uniform(-1.5, 1.0)
    can = Parameters(a=a, c=a * rng.uniform(0.02, 2.0), h=10.0 ** rng.uniform(-2.0, 1.0))
    phi = 10.0 ** rng.uniform(-3.0, np.log10(1.55))
    psi_dot, theta_dot = rng.choice([-1, 1], 2) * 10.0 ** rng.uniform(-1.5, 0.7, 2)
    if rng.random() < 0.5:
        theta_dot = steady_rotation(can, phi, psi_dot)
    phi_dot = rng.integers(2) * rng.normal() * 10.0 ** rng.uniform(-6.0, 0.0)
    release = {"phi": phi, "phi_dot": phi_dot, "psi_dot": psi_dot, "theta_dot": theta_dot}
    return can, {name: float(value) for name, value in release.items()}


@pytest.mark.slow
def test_round_off_of_the_energy_is_bounded_and_not_by_much() -> None:
    """At distances from the release of 1e-10 of the way to all of it, up, down and deep down."""
    rng, shares = np.random.default_rng(1), []
    for _ in range(RELEASES):
        can, release = random_release(rng)
        well = released_potential(
            can_constants(can),
            series_of(can),
            **{name: np.array([value]) for name, value in release.items()},
        )
        r, third = release["phi"], PLACES // 3
        down = r * (1 - 10.0 ** rng.uniform(-10.0, -0.02, third))
        deep = r * 10.0 ** rng.uniform(-6.0, -0.3, third)
        up = r + (np.pi / 2 - r) * 10.0 ** rng.uniform(-10.0, 0.0, third)
        phi = np.concatenate([down, deep, up])[:, None]
        state = evaluate_potential(well, phi, r - phi)
        bound = energy_noise(well, phi, r - phi, state)
        with mp.workdps(DIGITS):
            numbers = {"a": can.a, "c": can.c, "h": can.h, **release}
            exact = Potential({name: mp.mpf(value) for name, value in numbers.items()})
            truth = [exact.g(mp.mpf(float(at))) for at in phi[:, 0]]
            g = state.slope * (r - phi)
            error = [abs(float(mp.mpf(float(v)) - t)) for v, t in zip(g[:, 0], truth, strict=True)]
        shares.append(np.array(error) / bound[:, 0])
    assert np.isfinite(shares).all()
    # where in the range depends on the last bits of sines and logarithms of the machine
    assert 0.5 < np.max(shares) < 1.0
