"""The peaks of a bounce: of two humps the higher one, whichever of them the samples hit better."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from reference import (
    PAPER_CAN,
    Compliance,
    Effects,
    Gravity,
    Kind,
    Mass,
    Problem,
    Restitution,
    friction_ratio,
    solve,
)
from tests.support.compiled import needs_numba

OFF_CENTRE = Problem(
    parameters=PAPER_CAN,
    phi=0.37002169901361626,
    phi_dot=-0.08412154288046247,
    psi_dot=0.8827441894649443,
    theta_dot=0.1462584221382182,
    bounces=1,
    effects=Effects(
        mass=Mass(
            share=0.2008115490412127,
            x=0.0015321146004453334,
            y=-0.3430852362064796,
            z=-0.39058924287966046,
        )
    ),
)
DRILLING = Problem(
    parameters=PAPER_CAN,
    phi=0.1065778869380251,
    psi_dot=0.16479547103201123,
    theta_dot=3.2217777672205495e-05,
    bounces=1,
    effects=Effects(drilling=0.00118642610619907),
)
# the bounce after this one has a peak beside the maximum that both share, and more friction
TILTED = Problem(
    parameters=PAPER_CAN,
    phi=0.4618103105666153,
    phi_dot=0.023260661812454505,
    psi_dot=1.5869542823520706,
    theta_dot=-0.5778316490166546,
    bounces=1,
    effects=Effects(
        gravity=Gravity(constant=(-0.03363412008394017, 0.018006528276739164, -0.9992719904538494))
    ),
)


@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=needs_numba)])
@pytest.mark.parametrize(
    "problem", [OFF_CENTRE, DRILLING, TILTED], ids=["off-centre", "drilling", "tilted"]
)
def test_the_peak_is_the_largest_of_many_samples(problem: Problem, *, compiled: bool) -> None:
    motion = solve(problem, compiled=compiled)
    force = motion.at(np.linspace(motion.maxima[0], motion.maxima[1], 40_001)).force
    assert force is not None
    dense = float((np.hypot(force[:, 0], force[:, 1]) / force[:, 2]).max())
    assert motion.bounces[0].peak_friction_ratio == pytest.approx(dense, rel=1e-7)
    assert motion.bounces[0].peak_friction_ratio >= dense * (1.0 - 1e-12)


RIGID = Effects(restitution=Restitution(coefficient=0.5))
LIFTS = [
    Effects(compliance=Compliance(stiffness=1e3, damping=5.0)),
    Effects(compliance=Compliance(stiffness=1e3)),
    RIGID,
]
# phi, phi', psi', theta': in the first the plane lets go a rounding before the flight begins
THROWN = [
    (0.37309208119920184, -1.3409895748270435, 0.6438717378864841, -2.8728409050920893),
    *((0.35, -1.3 - 0.002 * n, 0.6 + 0.001 * n, -2.7 - 0.003 * n) for n in range(8)),
]


def _thrown(release: tuple[float, float, float, float], effects: Effects) -> Problem:
    phi, phi_dot, psi_dot, theta_dot = release
    return Problem(
        parameters=PAPER_CAN,
        phi=phi,
        phi_dot=phi_dot,
        psi_dot=psi_dot,
        theta_dot=theta_dot,
        bounces=1,
        effects=effects,
    )


@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=needs_numba)])
@pytest.mark.parametrize("release", THROWN)
@pytest.mark.parametrize("effects", LIFTS, ids=["damped", "undamped", "rigid"])
def test_friction_without_limit_has_no_peak_where_the_rim_lifts(
    effects: Effects, release: tuple[float, float, float, float], *, compiled: bool
) -> None:
    motion = solve(_thrown(release, effects), compiled=compiled)
    lift = next(
        before.end
        for before, after in pairwise(motion.phases)
        if (before.kind, after.kind) == (Kind.STICK, Kind.FLIGHT)
    )
    assert motion.maxima[0] < lift < motion.maxima[1]
    ratios = friction_ratio(motion.at(lift - np.array([1e-3, 1e-4, 1e-5])), PAPER_CAN)
    assert (ratios[1:] > 5 * ratios[:-1]).all()
    assert motion.bounces[0].peak_friction_ratio == np.inf


@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=needs_numba)])
@pytest.mark.parametrize(
    ("effects", "mu", "release"),
    [
        *((effects, 1.0, release) for effects in LIFTS for release in THROWN[::3]),
        # of those that slip as they lift, and leave round-offs of both forces
        (
            Effects(restitution=Restitution(coefficient=0.2898762186725423)),
            3.0,
            (0.3357434279302534, -0.9024980336022159, 0.4400815936742119, -2.5312109234381217),
        ),
        (
            Effects(restitution=Restitution(coefficient=0.3747779536998144)),
            0.05,
            (0.3771047553382898, -1.2757445481360568, 0.5860611169440253, -2.6827750013872906),
        ),
    ],
)
def test_limited_friction_has_a_peak_where_the_rim_lifts(
    effects: Effects, mu: float, release: tuple[float, float, float, float], *, compiled: bool
) -> None:
    # the normal force takes the friction along, and a rim that sticks lets go just beyond its cone
    motion = solve(_thrown(release, replace(effects, mu=mu)), compiled=compiled)
    assert Kind.FLIGHT in [phase.kind for phase in motion.phases]
    assert motion.bounces[0].peak_friction_ratio == pytest.approx(mu, rel=1e-8)


def test_a_can_that_lands_on_its_face_and_flies_has_pushed_until_then() -> None:
    motion = solve(Problem(parameters=PAPER_CAN, phi=0.3, bounces=1, effects=RIGID))
    land = next(phase.end for phase in motion.phases if phase.kind is Kind.STICK)
    before = np.linspace(0.0, land, 2_001)[:-1]  # the peak is at the end, half a step beyond
    dense = float(friction_ratio(motion.at(before), PAPER_CAN).max())
    assert motion.bounces[0].peak_friction_ratio == pytest.approx(dense, rel=1e-3)
