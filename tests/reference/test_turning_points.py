"""The turning points are the first roots of the energy left, on either side of the release."""

from typing import Any

import numpy as np
import pytest

from reference import Outcome, Parameters, exact_bounces
from reference.equations.steady_motion import steady_rotation
from reference.integrable.brackets import first_brackets, stays_positive
from reference.integrable.cycle import released_potential
from reference.integrable.effective_potential import nutation_force
from reference.integrable.frobenius import CanConstants, frobenius_series, lift
from reference.integrable.turning_points import OUTCOMES, turning_points
from reference.problem.states import Floats

UPPER_WELL: dict[str, Any] = {
    "a": 0.2919,
    "c": 0.3791,
    "h": 0.5575,
    "phi": 1.5026354274572624,
    "psi_dot": -0.39236159644870505,
    "theta_dot": -1.0199477967008015,
}


def test_a_release_in_an_upper_well_stays_in_it() -> None:
    """The other well is deeper; period and phi_min of model "rolling" and of DOP853."""
    cycles = exact_bounces(**UPPER_WELL)
    assert cycles.outcome(0) is Outcome.FINISHED
    assert cycles.phi_min[0] == pytest.approx(1.4638668898376, rel=1e-11)
    assert cycles.period[0] == pytest.approx(46.30751957, rel=1e-8)


BESIDE_A_BARRIER: dict[str, Any] = {
    "a": 7.85944030336767,
    "c": 9.93054264703082,
    "h": 0.9529075306825475,
    "phi": 1.1002121860593412,
    "psi_dot": 0.3582285989643633,
    "theta_dot": 0.0975590220140321,
}


def test_a_release_at_rest_beside_a_barrier_keeps_its_digits() -> None:
    """It rises with 1e-4 of its weight; sixty digits of `tests.reference.hostile.truth`."""
    cycles = exact_bounces(**BESIDE_A_BARRIER)
    # an ulp of a number given changes the period by 4e-13 or less
    assert cycles.period[0] == pytest.approx(115.4954713527583, rel=1e-12)


FAST = 1e-4


@pytest.mark.parametrize("phi_dot", [1e-12, -1e-12, FAST])
def test_turning_points_of_a_moving_release(phi_dot: float) -> None:
    """The climb and the fall of a release that hardly moves are too small for phi to hold."""
    release = {**BESIDE_A_BARRIER, "phi_dot": phi_dot}
    can = CanConstants(**{name: np.array(release.pop(name)) for name in "ach"})
    series = lift(frobenius_series(can))
    well = released_potential(
        can, series, **{name: np.array([value]) for name, value in release.items()}
    )
    found = turning_points(well, certain=True)
    assert OUTCOMES[found.code[0]] is Outcome.FINISHED
    assert found.swing[0] == found.climb[0] + found.fall[0]
    pull = float(nutation_force(can, well.b, well.spin, well.reference)[0])
    assert pull > 0
    # down to where the force has taken the energy: its slope takes a share of it
    share = 0.2 if phi_dot == FAST else 1e-6
    assert found.fall[0] == pytest.approx(float(well.excess[0] / pull), rel=share, abs=0.0)


def quadratic(gap: float) -> tuple[Floats, Floats]:
    """Two roots a distance 2 sqrt(-gap) apart about 0.5, or none, and a third at 0.1."""

    def f(_which: np.ndarray, x: Floats) -> tuple[Floats, Floats]:
        value = ((x - 0.5) ** 2 + gap) * (x - 0.1)
        return value, np.full(x.shape, 1e-16)

    found = first_brackets(f, np.array([1.0]), np.array([0.01]))
    assert found.found[0]
    return (found.near, found.far) if found.decided[0] else (np.empty(0), np.empty(0))


@pytest.mark.parametrize("gap", [-1e-1, -1e-4, -1e-8, -1e-12, -1e-14])
def test_the_nearer_of_two_close_roots_is_bracketed(gap: float) -> None:
    near, far = quadratic(gap)
    root = 0.5 + np.sqrt(-gap)
    assert far[0] <= root <= near[0]
    assert far[0] > 0.5 - np.sqrt(-gap)


@pytest.mark.parametrize("gap", [1e-1, 1e-4, 1e-8, 1e-12, 1e-14])
def test_a_minimum_that_does_not_reach_zero_is_passed(gap: float) -> None:
    near, far = quadratic(gap)
    assert far[0] <= 0.1 <= near[0]


def test_what_is_below_round_off_is_not_decided() -> None:
    def f(_which: np.ndarray, x: Floats) -> tuple[Floats, Floats]:
        return (x - 0.5) ** 2 + 1e-17, np.full(x.shape, 1e-16)

    assert not first_brackets(f, np.array([1.0]), np.array([0.01])).decided[0]


def test_a_cosine_series_is_positive_only_where_it_is() -> None:
    """1 + t + cos(9 u) is positive for t > 0 alone; 64 points miss its minimum by 1e-2 or less."""
    above = np.array([0.1, 1e-3, -1e-3, -0.1])
    series = np.zeros((32, 4))
    series[0], series[9] = 1 + above, 1.0
    at = np.pi * (np.arange(32) + 0.5) / 32
    values = series[0] + np.cos(9 * at)[:, None]
    positive = stays_positive(values, series)
    assert positive[0]
    assert not positive[2:].any()


def test_a_dip_halfway_between_two_points_is_seen() -> None:
    """With the ends among the 34 points these are pi/33 apart, and no pi/34."""
    points, wave = 34, 2
    halfway = wave**2 / 8 * ((np.pi / (points - 1)) ** 2 - (np.pi / points) ** 2)
    above = np.array([0.01, -halfway / 2])
    series = np.zeros((16, 2))
    series[0], series[wave] = 1 + above, 1.0
    at = np.linspace(0.0, np.pi, points)
    values = series[0] + np.cos(wave * at)[:, None]
    assert (values > 0).all()
    assert stays_positive(values, series).tolist() == [True, False]


def test_a_function_that_is_all_round_off_is_not_decided() -> None:
    def f(_which: np.ndarray, x: Floats) -> tuple[Floats, Floats]:
        return np.full(x.shape, 1e-17), np.full(x.shape, 1e-16)

    brackets = first_brackets(f, np.array([1.0]), np.array([0.01]))
    assert not brackets.found[0]
    assert not brackets.decided[0]


def test_a_release_that_leaves_a_steady_motion_overturns_in_any_company() -> None:
    # g is least at the release itself, where it is the energy of the release and not round-off
    cans: dict[str, Any] = {
        "a": 0.051641924872913275,
        "c": 0.03047555427588795,
        "h": 1.693891301575401,
    }
    release: dict[str, Any] = {
        "phi": 0.6704213976242159,
        "phi_dot": 5.907536597786241e-10,
        "psi_dot": 0.19238364279213538,
        "theta_dot": 0.7625935640693936,
    }
    other = {
        "a": 0.04473633279240803,
        "c": 0.04874630833408937,
        "h": 0.012686000972961492,
        "phi": 1.0464214046822744,
        "phi_dot": -0.17578841554403193,
        "psi_dot": 0.6647522651024191,
        "theta_dot": -1.0356700623658022,
    }
    alone = exact_bounces(**cans, **release)
    pairs: dict[str, Any] = {name: [one, other[name]] for name, one in (cans | release).items()}
    both = exact_bounces(**pairs)
    assert alone.outcome(0) is both.outcome(0) is Outcome.OVERTURNED


@pytest.mark.parametrize(("off", "ending"), [(1e-9, Outcome.FINISHED), (7e-10, Outcome.STEADY)])
def test_a_swing_of_less_than_a_billionth_of_phi_is_steady(off: float, ending: Outcome) -> None:
    """Off the steady motion by a share of phi: the swing is 1.2 of it."""
    can, phi, psi_dot = Parameters(a=0.6, c=1.0, h=0.5), 0.3, 2.0
    release: dict[str, Any] = {"phi": phi * (1 + off), "psi_dot": psi_dot}
    release["theta_dot"] = steady_rotation(can, phi, psi_dot)
    cycles = exact_bounces(a=can.a, c=can.c, h=can.h, **release)
    assert cycles.outcome(0) is ending
    if ending is Outcome.FINISHED:
        share = 1 - cycles.phi_min[0] / cycles.phi_max[0]
        assert 1e-9 < share < 1.5e-9
