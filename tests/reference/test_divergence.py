"""What is called chaotic, and what is not: regular motions, however they end."""

import math
from dataclasses import replace

import pytest

import reference.chaos
from reference import PAPER_CAN, Effects, Gravity, Mass, Problem, Solution, divergence, solve

ROCKING = Problem(parameters=PAPER_CAN, phi=0.3, psi_dot=0.06, bounces=1)


def tilted(angle: float) -> Effects:
    return Effects(gravity=Gravity(constant=(math.sin(angle), 0.0, -math.cos(angle))))


SHAKEN = Effects(gravity=Gravity(amplitude=(3.6e-3, 0.0, 3.6e-3), rate=11.6))


@pytest.mark.parametrize(
    "problem",
    [
        replace(ROCKING, effects=Effects(mass=Mass(share=1e-3, z=1.0))),
        replace(ROCKING, effects=tilted(1e-3)),
        replace(ROCKING, phi=0.2, effects=tilted(1.5)),
        replace(ROCKING, phi=0.2, psi_dot=0.0, effects=SHAKEN),
        replace(ROCKING, phi=0.2, psi_dot=0.0, phi_dot=-0.3, effects=SHAKEN),
    ],
    ids=["mass on the axis", "tilted", "overturned", "shaken flat", "thrown flat"],
)
def test_a_regular_motion_is_not_called_chaotic_where_its_horizon_is_rounded(
    problem: Problem,
) -> None:
    found = divergence(problem)
    assert not found.chaotic
    # like time, and as a bounce turns
    assert found.growth < reference.chaos.CHAOTIC


@pytest.mark.parametrize(("early", "parted"), [(4e-16, False), (1e-6, True)])
def test_a_copy_has_parted_only_if_it_ends_earlier(
    monkeypatch: pytest.MonkeyPatch, early: float, *, parted: bool
) -> None:
    """The horizon of a copy is that of the motion, but for the last bit of its time."""

    def shorter(problem: Problem, *, model: str) -> Solution:
        found = solve(problem, model=model)
        return replace(found, t_end=found.t_end * (1 - early))

    own = solve(ROCKING)
    monkeypatch.setattr(reference.chaos, "solve", shorter)
    found = divergence(ROCKING, own)
    assert bool(found.distance[-1] >= reference.chaos.PARTED) is parted
    # one copy that ends in another way is no exponential growth
    assert not found.chaotic
