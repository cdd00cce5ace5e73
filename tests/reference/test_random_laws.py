"""Random scenes of every law of contact: none fails, and the plane never pulls."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from reference import Effects, Mass, Outcome, Parameters, Problem, solve
from reference.nonsmooth.segments import SegmentsPath

SCENES = 1000
# In sqrt(R/g): a few tens of steps of most motions.
SHORT = 1.5
FAILURES = {Outcome.OUTWORKED, Outcome.STALLED, Outcome.UNRESOLVED}
# Of a normal force at lift-off, where it is zero but for the roundings of the last step.
ROUNDINGS = 1e-12


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawn:
    """A random scene and what its laws are.

    Attributes
    ----------
    problem : Problem
    laws : frozenset of str
    """

    problem: Problem
    laws: frozenset[str]


def drawn(number: int) -> Drawn:
    """Return a random scene of at least one law: cans from disks to rods, with and without slip."""
    random = np.random.default_rng((22, number))
    a = float(10.0 ** random.uniform(-0.8, 0.5))
    can = Parameters(a=a, c=a * float(random.uniform(0.3, 2.0)), h=float(random.uniform(0.05, 2.0)))
    values: dict[str, float] = {}
    laws = [
        name
        for name in ("contour", "contour_damping", "film", "boundary_layer", "static", "patch")
        if random.random() < 0.4
    ] or ["patch"]
    if {"static", "patch"} & set(laws) or random.random() < 0.3:
        values["mu"] = float(random.uniform(0.05, 1.0))
    for name in laws:
        if name == "static":
            values["mu_static"] = values["mu"] * float(random.uniform(1.0, 1.6))
        else:
            low, high = (-4.0, -0.5) if name == "patch" else (-4.0, -1.5)
            values[name] = float(10.0 ** random.uniform(low, high))
    mass = None
    if random.random() < 0.2:
        x, y = random.uniform(-0.5, 0.5, 2).tolist()
        mass = Mass(share=float(random.uniform(0.05, 0.5)), x=x, y=y)
    slips = "mu" in values and random.random() < 0.4
    psi_dot, theta_dot, phi_dot = random.normal(0.0, 0.5, 3).tolist()
    problem = Problem(
        parameters=can,
        phi=float(10.0 ** random.uniform(-2.0, 0.0)),
        phi_dot=0.2 * phi_dot,
        psi_dot=psi_dot,
        theta_dot=theta_dot,
        slip=tuple(random.normal(0.0, 0.3, 2).tolist()) if slips else (0.0, 0.0),
        duration=SHORT,
        effects=replace(Effects(**values), mass=mass),  # type: ignore[arg-type] # by name
    )
    return Drawn(problem=problem, laws=frozenset(laws))


def fault_of(problem: Problem) -> str:
    """Return what is wrong with the solution of a problem; nothing if nothing is."""
    found = solve(problem, outputs=frozenset({"contact_locus"}))
    if found.outcome in FAILURES:
        return f"{found.outcome.name} at {found.t_end:.6g}"
    if found.t_end == 0.0:
        return ""
    assert isinstance(found.path, SegmentsPath)
    states = found.at(np.linspace(0.0, found.t_end, 60))
    numbers = (states.phi, states.psi_dot, states.theta_dot, states.force, states.slip)
    if any(one is None or not np.isfinite(one).all() for one in numbers):
        return "not a number"
    assert states.force is not None
    pull = float(states.force[:, 2].min())
    return f"pulled with {-pull:.2g} m g" if pull < -ROUNDINGS else ""


@pytest.mark.slow
@pytest.mark.parametrize("number", range(5, SCENES, 10))
def test_a_random_scene_has_a_motion_that_the_plane_only_pushes(number: int) -> None:
    assert not fault_of(drawn(number).problem)


def test_every_law_is_drawn_with_every_other() -> None:
    sets = [drawn(number).laws for number in range(SCENES)]
    names = sorted(frozenset().union(*sets))
    assert len(names) == 6
    for one in names:
        for other in names:
            assert sum({one, other} <= laws for laws in sets) > 50
