"""A patch of contact: its law by quadrature, its motion as a body, its holds and its limits."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reference import PAPER_CAN, Compliance, EffectError, Effects, Outcome, Problem, Solution, solve
from reference.equations.contact_laws import Kind, Mode
from reference.equations.newton_euler import GeneralEquations
from reference.equations.patch_friction import (
    force_and_moment,
    friction_limit,
    friction_of_patch,
    motion_against,
)
from reference.equations.state_vector import DISSIPATED, SUPPLIED
from reference.nonsmooth import patch_onset
from reference.nonsmooth.patch_onset import rim_of
from reference.nonsmooth.segments import SegmentsPath
from tests.support import free_body

LOCUS = frozenset({"contact_locus"})
EFFECTS = Effects(mu=1.0, patch=0.1)
CREEPS = Problem(
    parameters=PAPER_CAN, phi=0.3, psi_dot=0.25, theta_dot=-0.1, duration=3.0, effects=EFFECTS
)
# Until shortly before friction stops both slip and turning.
TURNS = replace(CREEPS, duration=0.6)
SLIDES = replace(CREEPS, slip=(0.4, 0.2), duration=0.4, effects=replace(EFFECTS, mu=0.3))
# It turns, is held, and begins to move again: fourteen phases in twenty units of time.
STOPS = replace(
    CREEPS,
    phi_dot=0.1,
    psi_dot=0.02,
    theta_dot=-0.02,
    slip=(0.1, 0.2),
    duration=20.0,
    effects=Effects(mu=0.6, patch=0.02),
)
# Of the rules on each ray and chord, where a body is stepped.
NODES = 20


def by_quadrature(c: float, nodes: int = NODES) -> tuple[float, float]:
    """Return f and m of unit friction on every element of the patch, a = 1.

    In polar coordinates about the centre of turning, at c, all elements on a ray move alike; along
    the chord the pressure is the root of a quadratic.
    """
    if c < 1:
        ray = 2 * math.pi * np.arange(8 * nodes) / (8 * nodes)
        weight = np.full(8 * nodes, 2 * math.pi / (8 * nodes))
        x, along = np.polynomial.legendre.leggauss(nodes)
        reach = np.sqrt(1 - (c * np.sin(ray)) ** 2) - c * np.cos(ray)
        t = (x + 1) / 2
        distance = reach[:, None] * (1 - t**2)
        width = reach[:, None] * t * along
    else:
        # rays that meet the patch, and Gauss's rule for a root at both ends of each chord
        turn, weight = (math.pi / 2 * one for one in np.polynomial.legendre.leggauss(nodes))
        ray = math.pi + np.arcsin(np.sin(turn) / c)
        weight = weight * np.cos(turn) / np.sqrt(c * c - np.sin(turn) ** 2)
        x = np.cos(math.pi * np.arange(1, nodes + 1) / (nodes + 1))
        half = np.cos(turn)[:, None]
        distance = -c * np.cos(ray)[:, None] + half * x
        width = half * math.pi / (nodes + 1) * np.sqrt(1 - x**2)
    right = np.cos(ray)[:, None]
    across, up = c + distance * right, distance * np.sin(ray)[:, None]
    pressure = 1.5 / math.pi * np.sqrt(np.maximum(1 - across**2 - up**2, 0.0))
    share = weight[:, None] * pressure * distance * width
    lever = across * right + up * np.sin(ray)[:, None]
    return -float((share * right).sum()), float((share * lever).sum())


@pytest.mark.parametrize("c", [0.0, 0.2, 0.7, 0.9, 1.1, 1.5, 1.9, 2.0, 2.1, 7.0])
def test_the_closed_forms_are_the_integrals_over_the_patch(c: float) -> None:
    over_slide, over_turn, _ = force_and_moment(np.array([c]), np.ones(1))
    f, m = by_quadrature(c, 200)
    assert float(over_slide[0] * c) == pytest.approx(f, abs=2e-13)
    assert float(over_turn[0]) == pytest.approx(m, abs=2e-13)


def test_the_law_is_smooth_and_has_the_limits_of_a_point_and_of_pure_drilling() -> None:
    step = 1e-40
    for c in (0.3, 0.999999, 1.000001, 1.999999, 2.000001, 50.0):
        shifted = force_and_moment(np.array([c + 1j * step]), np.ones(1, dtype=complex))
        f, m, slope = shifted[0] * (c + 1j * step), shifted[1], shifted[2]
        # f' is what the law says, and m' = -c f'
        assert f[0].imag / step == pytest.approx(slope[0].real, rel=1e-12)
        assert m[0].imag / step == pytest.approx(-c * slope[0].real, rel=1e-9)
    drilled = friction_of_patch(np.array([[0.0], [0.0], [-2.0]]))
    assert drilled.ravel() == pytest.approx([0.0, 0.0, 3 * math.pi / 16], rel=1e-15)
    slid = friction_of_patch(np.array([[3.0], [4.0], [0.0]]))
    assert slid.ravel() == pytest.approx([-0.6, -0.8, 0.0], rel=1e-15)


def test_every_reaction_has_the_motion_that_it_opposes() -> None:
    random = np.random.default_rng(3)
    reaction = random.normal(size=(3, 500)) * 10.0 ** random.uniform(-8, 0, (3, 500))
    motion = motion_against(reaction)
    back = friction_of_patch(motion) * np.linalg.norm(motion, axis=0)
    assert (
        np.linalg.norm(back - reaction, axis=0) < 3e-15 * np.linalg.norm(reaction, axis=0)
    ).all()


@pytest.mark.parametrize("problem", [TURNS, SLIDES])
def test_a_body_of_six_degrees_of_freedom_moves_the_same(problem: Problem) -> None:
    mu, radius = problem.effects.mu or 0.0, problem.effects.patch

    def wrench(slip: np.ndarray, turning: float) -> tuple[np.ndarray, float]:
        speed = math.hypot(*slip)
        f, m = by_quadrature(speed / (radius * abs(turning)))
        against = -slip / speed if speed else np.zeros(2)
        return mu * f * against, -mu * radius * m * math.copysign(1.0, turning)

    times = np.linspace(0.0, problem.duration or 0.0, 30)
    theirs = solve_ivp(
        lambda _t, y: free_body.accelerated(y, problem, wrench)[0],
        (0.0, times[-1]),
        free_body.released(problem),
        "DOP853",
        t_eval=times,
        rtol=1e-12,
        atol=1e-14,
    )
    ours = solve(problem).at(times)
    phi, psi = free_body.angles(theirs.y)
    slips = [math.hypot(*free_body.slip_of(y, PAPER_CAN.h)[:2]) for y in theirs.y.T]
    assert ours.slip is not None
    assert np.abs(phi - ours.phi).max() < 1e-10
    assert np.abs(psi - ours.psi).max() < 1e-9
    apart = np.abs(slips - np.hypot(*ours.slip.T))
    # what the tolerance of DOP853 leaves
    assert apart[: times.size // 2].max() < 1e-12
    # and what twenty nodes do, where the centre of turning crosses the edge of the patch
    assert apart.max() < 1e-8


def rows_of(found: Solution, times: np.ndarray) -> np.ndarray:
    assert isinstance(found.path, SegmentsPath)
    return np.asarray(found.path.rows(times)[0])


@pytest.mark.parametrize(
    "motion",
    [(1.0, 0.3, 0.2), (0.1, -0.2, 0.5), (0.3, 0.4, -0.5), (0.0, 0.0, 1.0), (3.0, 4.0, 0.0)],
)
def test_the_limit_of_a_reaction_and_its_slopes(motion: tuple[float, float, float]) -> None:
    """A reaction of the limit surface is homogeneous in mu N, and its normal is the motion."""
    q = np.array(motion)[:, None]
    reaction = 0.7 * friction_of_patch(q)
    assert friction_limit(reaction) == pytest.approx([0.7], rel=1e-14)
    slopes = [
        friction_limit(reaction + 1e-40j * np.eye(3)[:, [k]]).imag[0] / 1e-40 for k in range(3)
    ]
    step = 1e-6
    for k in range(3):
        aside = step * np.eye(3)[:, [k]]
        difference = (friction_limit(reaction + aside) - friction_limit(reaction - aside))[0] / (
            2 * step
        )
        assert slopes[k] == pytest.approx(difference, abs=1e-8)


@pytest.mark.parametrize("problem", [CREEPS, SLIDES, STOPS])
def test_energy_is_there_or_lost_and_the_plane_pushes(problem: Problem) -> None:
    found = solve(problem, outputs=LOCUS)
    rows = rows_of(found, np.linspace(0.0, found.t_end, 400))
    equations = GeneralEquations(parameters=PAPER_CAN, effects=problem.effects)
    energy = equations.energy(rows, Mode(slips=True))
    assert (np.diff(rows[DISSIPATED]) > -1e-16).all()
    assert np.ptp(energy + rows[DISSIPATED] - rows[SUPPLIED]) < 1e-12
    force = found.at(np.linspace(0.0, found.t_end, 400)).force
    assert force is not None
    assert force[:, 2].min() > 0.0


def test_it_is_held_inside_its_limit_surface_and_lets_go_on_it() -> None:
    found = solve(STOPS, outputs=LOCUS)
    equations = GeneralEquations(parameters=PAPER_CAN, effects=STOPS.effects)
    held = [phase for phase in found.phases if phase.kind is Kind.STICK]
    assert len(held) >= 5
    for phase in held:
        times = np.linspace(phase.start, phase.end, 40)[1:]
        contact = equations.contact(rows_of(found, times - 1e-12), Mode())
        reaction, limit = rim_of(equations).reaction(equations, contact)
        used = np.linalg.norm(reaction, axis=0) / limit
        assert used.max() <= 1 + 1e-8
        if phase.end < found.t_end:
            assert used[-1] == pytest.approx(1.0, abs=1e-8)


def changed(radius: float, mu: float) -> float:
    """Return by how much a patch of a radius moves phi of a rocking can with a point contact."""
    times = np.linspace(0.1, 3.9, 20)
    point = replace(CREEPS, duration=4.0, effects=Effects(mu=mu))
    patch = replace(point, effects=Effects(mu=mu, patch=radius))
    return float(np.abs(solve(patch).at(times).phi - solve(point).at(times).phi).max())


def test_a_small_patch_changes_a_point_that_sticks_in_proportion() -> None:
    assert changed(2e-4, 0.6) == pytest.approx(2 * changed(1e-4, 0.6), rel=2e-3)


def test_where_the_point_begins_to_slip_the_order_is_four_fifths() -> None:
    order = math.log10(changed(1e-6, 0.3) / changed(1e-8, 0.3)) / 2
    assert order == pytest.approx(0.8, abs=0.03)


@pytest.mark.parametrize(
    "values",
    [{"patch": -0.1, "mu": 0.3}, {"patch": 0.1}, {"patch": 0.1, "mu": 0.3, "drilling": 0.1}],
)
def test_what_makes_no_sense_is_refused_by_its_key(values: dict[str, float]) -> None:
    with pytest.raises(EffectError) as caught:
        Effects(**values)  # type: ignore[arg-type]
    assert caught.value.key == "patch"


def test_a_can_that_falls_in_a_plane_is_held_by_its_patch_as_by_its_point() -> None:
    falls = replace(CREEPS, psi_dot=0.0, theta_dot=0.0, effects=Effects(mu=2.0, patch=0.1))
    point = replace(falls, effects=Effects(mu=2.0))
    one, other = solve(falls), solve(point)
    assert one.outcome is other.outcome is Outcome.FELL_FLAT
    assert one.t_end == pytest.approx(other.t_end, rel=1e-14)


@pytest.mark.parametrize("law", [None, Compliance(stiffness=1e3, damping=20.0)])
def test_a_turning_that_is_a_round_off_is_none(law: Compliance | None) -> None:
    """Released without it psi' + theta' cos(phi) is a round-off, and no motion of the patch."""
    effects = Effects(mu=0.25, patch=0.05, compliance=law)
    rock = replace(CREEPS, phi=0.4, effects=effects, duration=2.0)
    found = solve(replace(rock, psi_dot=0.12, theta_dot=-0.12 / math.cos(0.4)))
    assert found.outcome is Outcome.FINISHED
    assert [phase.kind for phase in found.phases] == [Kind.STICK, Kind.SLIP]


@pytest.mark.parametrize("patch", [0.01, 0.1])
def test_friction_goes_on_where_a_patch_begins_to_move(patch: float) -> None:
    """Soon after, its motion is less than the round-off of its turning, and has a direction."""
    rock = replace(CREEPS, phi=0.4, effects=Effects(mu=0.25, patch=patch), bounces=1, duration=None)
    found = solve(replace(rock, psi_dot=0.12, theta_dot=-0.12 / math.cos(0.4)))
    lets_go = found.phases[1].start
    force = found.at(lets_go + np.array([-1e-6, 0.0, 1e-12, 1e-9, 1e-7, 1e-6])).force
    assert force is not None
    ratio = np.hypot(force[:, 0], force[:, 1]) / force[:, 2]
    assert ratio == pytest.approx(np.full(6, ratio[0]), rel=1e-5)
    assert ratio[0] < 0.25


def fast(psi_dot: float, patch: float, law: Compliance | None = None) -> Problem:
    """Return a can that turns fast, but not about the normal."""
    effects = Effects(mu=0.25, patch=patch, compliance=law)
    still = -psi_dot / math.cos(0.4)
    return Problem(
        parameters=PAPER_CAN,
        phi=0.4,
        psi_dot=psi_dot,
        theta_dot=still,
        effects=effects,
        duration=0.01,
    )


@pytest.mark.parametrize(
    ("psi_dot", "law"),
    [(30.0, None), (60.0, None), (300.0, None), (300.0, Compliance(stiffness=1e3, damping=20.0))],
)
def test_forces_as_large_as_they_may_be_let_a_patch_go_as_a_point(
    psi_dot: float, law: Compliance | None
) -> None:
    """The round-off by which a direction is known is that of the forces, hundreds of weights."""
    patch, point = (solve(fast(psi_dot, radius, law)) for radius in (0.1, 0.0))
    assert patch.outcome is point.outcome
    assert patch.t_end == pytest.approx(point.t_end, rel=1e-3)


def test_a_start_that_runs_away_does_not_take_the_others_with_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One of those all round ends at a singular matrix; nothing is found, which is an outcome."""
    monkeypatch.setattr(patch_onset, "NOISE", 1e-17)
    assert solve(fast(30.0, 0.1)).outcome is Outcome.INCONSISTENT


def test_a_patch_that_is_dropped_without_moving_has_states_in_the_air() -> None:
    law = Compliance(stiffness=1e3, damping=20.0)
    effects = Effects(mu=0.3, patch=0.02, compliance=law)
    dropped = Problem(parameters=PAPER_CAN, phi=0.3, height=0.05, duration=0.2, effects=effects)
    found = solve(dropped, outputs=LOCUS).at(np.linspace(0.0, 0.2, 5))
    assert found.force is not None
    assert not found.force.any()
    assert found.phi == pytest.approx(np.full(5, 0.3))
