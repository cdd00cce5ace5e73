"""Numbers that the reference's docstrings and sentences cite, just inside and just outside each.

They are written out here as prose has them, and not imported: whoever changes one in the code is
told which sentence no longer holds.
"""

# ruff: noqa: D102 - the methods of a toy are described where its role is

import math
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

import reference.analysis.validity
from reference import (
    PAPER_CAN,
    Effects,
    Finding,
    FindingKind,
    Outcome,
    Parameters,
    Problem,
    Solution,
    examine,
    solve,
)
from reference.analysis.agreement import Agreement
from reference.analysis.conditioning import Lost, round_off
from reference.nonsmooth.slip_onset import LEAN_OF_CAN, holding, reserve
from reference.problem.states import Floats, States, initial_states

EPS = 2.0**-52
GENTLE = Problem(parameters=PAPER_CAN, phi=0.4, psi_dot=0.12, theta_dot=-0.06, bounces=1)


# --- how far two methods agree --------------------------------------------------------------------


def agreement(discrepancy: float, *, allowed: float = 1.0, ulp: float = 0.0) -> Agreement:
    return Agreement(
        quantity="period", discrepancy=discrepancy, allowed=allowed, ulp=ulp, evaluations=0
    )


@pytest.mark.parametrize(("size", "known"), [(0.99e-3, True), (1e-3, True), (1.01e-3, False)])
def test_a_motion_is_known_to_three_digits_or_there_is_no_answer(
    size: float, *, known: bool
) -> None:
    assert agreement(size).resolved is known
    assert agreement(1e-12, ulp=size).resolved is known
    # one of the methods is wrong: that is said, and no ulp is to blame
    assert agreement(size, allowed=1e-4).resolved


@pytest.mark.parametrize(("size", "silent"), [(0.99e-9, True), (1e-9, True), (1.01e-9, False)])
def test_nine_digits_are_promised_and_what_is_less_is_said(size: float, *, silent: bool) -> None:
    assert (agreement(size).sentence == "") is silent
    # beyond what round-off allows it is said however small it is
    assert agreement(size, allowed=1e-12).sentence != ""


def test_each_of_64_operations_of_an_evaluation_rounds() -> None:
    """And as much is allowed again for the force at the extrema, which loses less here."""
    found = solve(GENTLE).agreement
    assert found is not None
    assert found.allowed == pytest.approx(2 * 64 * found.evaluations * EPS, rel=1e-12, abs=0)


# --- what round-off leaves of a motion ------------------------------------------------------------


@pytest.mark.parametrize(("lost", "silent"), [(0.99e-9, True), (1.01e-9, False)])
def test_an_ulp_of_phi_that_changes_the_force_by_a_billionth_is_said(
    lost: float, *, silent: bool
) -> None:
    angle, h = PAPER_CAN.balancing_angle, PAPER_CAN.h
    # the force of gravity is sqrt(h^2 + 1) times what phi is short of balance
    short = EPS * angle / (lost * math.hypot(h, 1.0))
    problem = Problem(parameters=PAPER_CAN, phi=angle - short, bounces=1)
    assert (round_off(problem, initial_states(problem)) is None) is silent


@pytest.mark.parametrize(("lost", "silent"), [(0.99e-9, True), (1.01e-9, False)])
def test_a_billionth_that_256_roundings_take_at_the_top_is_said(
    lost: float, *, silent: bool
) -> None:
    rate = 0.1
    left = math.sqrt(256 * EPS * (1 + rate**2) / lost)
    problem = Problem(parameters=PAPER_CAN, phi=0.3, phi_dot=rate, bounces=1)
    short = math.asin(left / math.hypot(PAPER_CAN.h, 1.0))
    top = initial_states(replace(problem, phi=PAPER_CAN.balancing_angle - short))
    said = round_off(problem, top)
    assert (said and said.lost) is (None if silent else Lost.ENERGY)


# --- what a motion breaks -------------------------------------------------------------------------


@dataclass(frozen=True)
class Still:
    """A path on which nothing moves."""

    phi: float = 0.3

    def at(self, times: Floats) -> States:
        ones = np.ones_like(times)
        rest = dict.fromkeys(
            ("phi_dot", "psi", "psi_dot", "theta", "theta_dot", "spin"), 0.0 * ones
        )
        return States(phi=self.phi * ones, slip=np.zeros((times.size, 2)), **rest)

    def nodes(self) -> tuple[Floats, States]:
        times = np.array([0.0, 1.0])
        return times, self.at(times)


def still(
    outcome: Outcome = Outcome.FINISHED, *, phi: float = 0.3, mu: float | None = None
) -> Solution:
    problem = Problem(parameters=PAPER_CAN, phi=phi, duration=1.0, effects=Effects(mu=mu))
    return Solution(
        problem=problem,
        model="rolling",
        method="regular",
        outcome=outcome,
        bounces=(),
        t_end=1.0,
        maxima=np.empty(0),
        minima=np.empty(0),
        steps=0,
        evaluations=0,
        path=Still(phi),
    )


@dataclass(frozen=True)
class Contact:
    """Makes the plane exert the same force at all times."""

    patch: pytest.MonkeyPatch

    def force(self, friction: float, normal: float) -> None:
        def same(states: States, _: Parameters) -> Floats:
            return np.tile((friction, 0.0, normal), (states.phi.size, 1))

        self.patch.setattr(reference.analysis.validity, "contact_force_in_world", same)


@pytest.fixture
def contact(monkeypatch: pytest.MonkeyPatch) -> Contact:
    return Contact(monkeypatch)


def findings(solution: Solution) -> tuple[Finding, ...]:
    return examine(solution, np.array([0.0, 1.0])).findings


def kinds(solution: Solution) -> list[FindingKind]:
    return [finding.kind for finding in findings(solution)]


@pytest.mark.parametrize(("friction", "few"), [(0.999, False), (1.001, True)])
def test_few_pairs_have_a_friction_above_one(
    contact: Contact, friction: float, *, few: bool
) -> None:
    contact.force(2.0 * friction, 2.0)
    assert [(one.kind, one.model) for one in findings(still())] == (
        [(FindingKind.FRICTION, "coulomb")] if few else []
    )


@pytest.mark.parametrize(("normal", "counts"), [(0.999e-3, False), (1.001e-3, True)])
def test_at_lift_off_a_thousandth_of_the_weight_is_pushed(
    contact: Contact, normal: float, *, counts: bool
) -> None:
    contact.force(5.0 * normal, normal)
    lifted = examine(still(Outcome.LIFTED), np.array([0.0, 1.0]))
    assert lifted.friction_ratio == pytest.approx(5.0 if counts else 0.0)
    # of a motion that does not end there every instant counts
    rolls = examine(still(), np.array([0.0, 1.0]))
    assert rolls.friction_ratio == pytest.approx(5.0)


@pytest.mark.parametrize(("gap", "near"), [(1.01e-9, False), (0.99e-9, True)])
def test_a_far_rim_within_a_billionth_of_the_radius_is_nearer_than_an_atom(
    contact: Contact, gap: float, *, near: bool
) -> None:
    contact.force(0.0, 1.0)
    assert (FindingKind.FAR_RIM in kinds(still(phi=math.asin(gap / 2)))) is near
    # what fell flat is no nearer than it says itself
    assert kinds(still(Outcome.FELL_FLAT, phi=math.asin(gap / 2))) == [FindingKind.ENDING]


@pytest.mark.parametrize("size", [0.1, 50.0])
@pytest.mark.parametrize(("excess", "wrong"), [(0.99e-8, False), (1.01e-8, True)])
def test_a_friction_beyond_its_cone_by_1e_8_of_the_weight_or_of_itself_is_wrong(
    contact: Contact, size: float, excess: float, *, wrong: bool
) -> None:
    mu = 0.5
    contact.force(size, (size - excess * max(1.0, size)) / mu)
    assert (FindingKind.CONE in kinds(still(mu=mu))) is wrong


@dataclass(frozen=True)
class Plane:
    """Equations of a plane as far as what holds on it is concerned."""

    mu_static: float = 0.5
    resistance: float = 0.25
    drilling: float = 0.125


@pytest.mark.parametrize(("excess", "held"), [(1.99e-9, True), (2.01e-9, False)])
def test_what_is_held_lets_go_2e_9_beyond_its_cone(excess: float, *, held: bool) -> None:
    nothing, more = np.zeros(1), 1.0 + excess
    contact = SimpleNamespace(
        force=np.array([[0.5 * more], [0.0], [1.0]]),
        moment=np.array([[0.0], [0.25 * more], [0.125 * more]]),
    )
    for left in (
        reserve(Plane(), contact),  # type: ignore[arg-type]
        reserve(Plane(), contact, LEAN_OF_CAN),  # type: ignore[arg-type]
        holding(Plane(), contact),  # type: ignore[arg-type]
    ):
        assert (left > nothing).all() == held
