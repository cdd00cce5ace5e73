"""The hard cases: scenes listed apart, each of which says why it is hard and where it is from."""

import itertools
import math

import pytest

from models import hard_names, load, names

LADDER = ("04", "08", "12", "16", "20", "24")


def test_hard_cases_are_not_in_the_catalogue() -> None:
    assert set(hard_names()).isdisjoint(names())
    assert {f"epsilon-1e-{rung}" for rung in LADDER} < set(hard_names())


@pytest.mark.parametrize("name", hard_names())
def test_a_hard_case_is_named_after_its_file_and_says_why_it_is_hard(name: str) -> None:
    scene = load(name)
    assert scene.name == name
    assert scene.cite.startswith("Hard because ")
    assert scene.cite.count(". ") >= 1, "a source follows the reason"
    assert scene.horizon.seconds is not None, "a run that sticks must end"


def test_the_ladder_falls_by_four_decades_of_epsilon_a_rung() -> None:
    # epsilon goes with the square of the rates, which are given to six digits
    rates = [load(f"epsilon-1e-{rung}").release.psi_dot for rung in LADDER]
    assert [a / b for a, b in itertools.pairwise(rates)] == pytest.approx([100.0] * 5)


@pytest.mark.parametrize(
    "name", ["tiny-can", "large-can", "light-can", "heavy-can", "microgravity", "hundred-g"]
)
def test_scaled_cans_are_the_gentle_one_in_their_own_units(name: str) -> None:
    def own(name: str) -> tuple[float, ...]:
        scene = load(name)
        unit = math.sqrt(scene.can.radius / scene.gravity)
        release, can = scene.release, scene.can
        return (
            can.a,
            can.c,
            can.h,
            release.phi,
            release.psi_dot * unit,
            release.theta_dot * unit,
        )

    # the rates are given to six digits
    assert own(name) == pytest.approx(own("gentle-rock"), rel=1e-5)


def test_every_kind_of_hard_case_that_was_asked_for_is_there() -> None:
    balance = load("gentle-rock").can.balancing_angle
    for offset, name in ((1e-5, "balance-1e-5"), (1e-12, "balance-1e-12")):
        # an ulp of 0.6, against 1e-12
        assert balance - load(name).release.phi == pytest.approx(offset, rel=2e-4, abs=0)
    assert load("planar-fall").release.psi_dot == load("planar-fall").release.theta_dot == 0.0
    assert load("thin-disk").can.h == pytest.approx(0.01)
    assert load("tall-can").can.h == pytest.approx(10.0)
    lamina = load("lamina-moments").can
    assert lamina.axial_inertia == pytest.approx(2.0 * lamina.transverse_inertia)
    assert load("needle-moments").can.c < 1e-6
    assert math.pi / 2 - load("spinning-cylinder").release.phi < 0.1
    assert load("fast-spin").release.theta_dot == 1e4
    assert load("drop-1-cm").release.height == 0.01
    assert load("start-in-penetration").release.height < 0.0
    frictions = [load(n).effects.slip for n in ("frictionless", "friction-below", "friction-above")]
    assert [slip.mu for slip in frictions if slip] == pytest.approx([0.0, 0.428331, 0.436984])
