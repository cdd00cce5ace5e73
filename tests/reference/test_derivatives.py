"""Derivatives of the first bounce: against differences in 84 digits, and one method by another."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from reference import PAPER_CAN, Effects, Mass, Parameters, Problem, solve
from reference.analysis.bounce_tangents import motion_tangents
from reference.analysis.sensitivity import sensitivity
from reference.equations.nonholonomic import nutation_acceleration
from reference.integrable import deep_tangents
from reference.integrable.derivatives import PULLED, QUANTITIES, batch_tangents
from reference.integrable.tangents import BY
from reference.nonsmooth.segments import SegmentsPath
from tests.support.varied import RELEASE, tilted, varied

GOLDEN = json.loads((Path(__file__).parent / "golden" / "derivatives.json").read_text())
ROCK: dict[str, Any] = {"phi": 0.4, "psi_dot": 0.12, "theta_dot": -0.06, "bounces": 1}


def posed(row: dict[str, Any]) -> Problem:
    can = Parameters(a=row["a"], c=row["c"], h=row["h"])
    return Problem(parameters=can, bounces=1, **{name: row[name] for name in RELEASE})


@pytest.mark.parametrize("row", GOLDEN, ids=lambda row: f"{row['can']} {row['phi']:.3g}")
def test_differences_in_84_digits(row: dict[str, Any]) -> None:
    """Every derivative to 1e-10 of itself; of friction and period to 1e-14.

    In a deep bounce some of these are a millionth of the others.
    """
    known = sensitivity(posed(row))
    assert known.method == "quadrature"
    for name, slopes in row["derivatives"].items():
        if name in known.why:
            assert known.why[name] == PULLED
            continue
        noise = 1e-14 if name in {"peak_friction_ratio", "period"} else 0.0
        for by, digits in slopes.items():
            slope = known.derivatives[name][known.by.index(by)]
            assert slope == pytest.approx(float(digits), rel=1e-10, abs=noise), (name, by)


def test_golden_derivatives_are_of_many_regimes() -> None:
    assert len({row["can"] for row in GOLDEN}) >= 3
    assert {np.sign(row["phi_dot"]) for row in GOLDEN} >= {-1.0, 0.0}
    smallest = min(sensitivity(posed(row)).values["phi_min"] for row in GOLDEN)
    assert smallest < 1e-4


@pytest.mark.parametrize("psi_dot", [0.12, 0.012, 1.2e-3])
def test_nutations_that_stay_and_that_go_with_the_first_integral_give_the_same(
    psi_dot: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To what is left at a nutation that stays: round-off, a few 1e-16, over phi_min."""
    rates = {"psi_dot": psi_dot, "theta_dot": -psi_dot / 2}
    problem = Problem(parameters=PAPER_CAN, phi_dot=-0.01, **(ROCK | rates))
    found = []
    for deep in (0.0, 1.0):
        monkeypatch.setattr(deep_tangents, "DEEP", deep)
        found.append(sensitivity(problem))
    stay, go = found
    for name in QUANTITIES:
        scale = np.abs(stay.derivatives[name]) + np.abs(stay.values[name])
        assert (
            np.abs(stay.derivatives[name] - go.derivatives[name]) <= 1e-15 / psi_dot * scale
        ).all()


def test_derivatives_of_deeper_and_deeper_bounces_go_as_a_logarithm() -> None:
    """The turn has a limit, which it nears by psi' ln(psi')."""
    slopes = []
    for psi_dot in (1e-6, 1e-9, 1e-12, 1e-15):
        rates = {"psi_dot": psi_dot, "theta_dot": -psi_dot / 2}
        known = sensitivity(Problem(parameters=PAPER_CAN, **(ROCK | rates)))
        slopes.append(known.derivatives["angle_of_turn"][known.by.index("psi_dot")])
    assert np.diff(slopes) == pytest.approx(np.full(3, slopes[1] - slopes[0]), rel=1e-5)


@pytest.mark.parametrize("phi_dot", [0.0, -0.05, 0.05])
def test_variational_equations_give_the_derivatives_of_the_quadrature(phi_dot: float) -> None:
    """Nothing is shared: one differentiates integrals over phi, the other follows the motion."""
    problem = Problem(parameters=PAPER_CAN, phi_dot=phi_dot, **ROCK)
    known = sensitivity(problem)
    by, jets, why = motion_tangents(problem)
    assert by == known.by
    assert why == known.why == {}
    for name in QUANTITIES:
        size = np.abs(known.derivatives[name]).max()
        assert np.abs(jets[name].slope - known.derivatives[name]).max() < 1e-11 * size, name
        assert jets[name].value == pytest.approx(known.values[name], rel=1e-11)


@pytest.mark.parametrize("before", [1e-2, 1e-4, 1e-6])
def test_of_a_release_shortly_before_its_minimum(before: float) -> None:
    """There a pole beside the release spoils the quadrature, and nobody gets its numbers."""
    rock = solve(Problem(parameters=PAPER_CAN, **ROCK), model="exact")
    state = rock.at(rock.minima[0] - before)
    names = ("phi", "phi_dot", "psi_dot", "theta_dot")
    late: dict[str, Any] = {name: float(getattr(state, name)[0]) for name in names}
    problem = Problem(parameters=PAPER_CAN, bounces=1, **late)

    def numbers(steps: int) -> np.ndarray:
        moved = replace(problem, phi=problem.phi * (1.0 + 1e-5 * steps))
        found = solve(moved, model="exact")
        return np.array([found.maxima[1] - found.maxima[0], found.bounces[0].angle_of_turn])

    one, two = numbers(1) - numbers(-1), numbers(2) - numbers(-2)
    differences = (8.0 * one - two) / (12.0 * 1e-5 * problem.phi)
    known = sensitivity(problem)
    for name, slope in zip(("period", "angle_of_turn"), differences, strict=True):
        assert known.derivatives[name][known.by.index("phi")] == pytest.approx(slope, rel=1e-6)


def test_derivatives_grow_like_one_over_the_distance_from_a_separatrix() -> None:
    sizes = []
    for distance in (1e-4, 1e-6, 1e-8):
        phi = PAPER_CAN.balancing_angle - distance
        own = sensitivity(Problem(parameters=PAPER_CAN, phi=phi, psi_dot=1e-9, bounces=1))
        sizes.append(own.derivatives["period"][own.by.index("phi")] * distance)
        assert "separatrix" in own.caveats[-1]
    # half of the way down from the balanced can: period = -2 ln(distance)/rate + ...
    rate = math.sqrt(math.sqrt(1 + PAPER_CAN.h**2) / PAPER_CAN.pendulum_inertia)
    assert np.abs(np.array(sizes) * rate / 2 - 1).max() < 1e-3
    far = sensitivity(Problem(parameters=PAPER_CAN, **ROCK))
    assert not any("separatrix" in sentence for sentence in far.caveats)


def test_many_at_once_are_each_by_itself() -> None:
    generator = np.random.default_rng(5)
    n = 12
    numbers = {
        "phi": generator.uniform(0.05, 0.5, n),
        "phi_dot": np.where(np.arange(n) % 2, 0.0, 0.04),
        "psi_dot": generator.uniform(-1, 1, n) * np.where(np.arange(n) % 3, 1.0, 1e-5),
        "theta_dot": generator.uniform(-1, 1, n),
    }
    cans = {name: np.full(n, getattr(PAPER_CAN, name)) for name in ("a", "c", "h")}
    cans["h"][: n // 2] = 1.1
    jets = batch_tangents(**numbers, **cans)
    for row in range(n):
        own = sensitivity(posed({k: float(v[row]) for k, v in (numbers | cans).items()}))
        for name in QUANTITIES:
            expected = own.derivatives[name]
            if own.method != "quadrature":
                expected = np.full(len(BY), np.nan)
            assert jets[name].slope[row] == pytest.approx(
                expected, rel=1e-9, abs=1e-12, nan_ok=True
            )


def measured(problem: Problem) -> np.ndarray[Any, np.dtype[np.float64]]:
    solution = solve(problem)
    bounce = solution.bounces[0]
    period = solution.maxima[1] - solution.maxima[0]
    return np.array([period, *(getattr(bounce, name) for name in QUANTITIES[1:])])


@pytest.mark.parametrize(
    ("effects", "names"),
    [
        (Effects(mu=0.3), ("phi", "psi_dot", "a", "h", "slip.mu")),
        (Effects(mu=0.1), ("phi", "theta_dot", "c", "slip.mu")),
        (Effects(gravity=tilted(0.02, 0.7)), ("phi", "tilt.angle", "tilt.direction")),
        (Effects(mass=Mass(share=0.05, x=0.3, z=0.2)), ("point_mass.mass", "point_mass.x", "h")),
        (Effects(rolling_resistance=0.003), ("phi", "rolling_resistance.length")),
    ],
    ids=["slips", "slips from the release on", "tilt", "mass", "resistance"],
)
def test_differences_of_motions_with_effects(effects: Effects, names: tuple[str, ...]) -> None:
    """To 1e-7 of what a change of the size of the number itself would do."""
    problem = Problem(parameters=PAPER_CAN, effects=effects, **ROCK)
    known = sensitivity(problem)
    assert known.method == "variational equations"
    assert not known.why
    for name in names:
        step = 2e-5
        one, two = (
            (measured(varied(problem, name, h)) - measured(varied(problem, name, -h))) / (2 * h)
            for h in (step, 2 * step)
        )
        extrapolated = (4 * one - two) / 3
        slopes = [known.derivatives[each][known.by.index(name)] for each in QUANTITIES]
        sizes = np.abs(slopes) + np.abs([known.values[each] for each in QUANTITIES])
        assert (np.abs(extrapolated - slopes) / sizes).max() < 1e-7, name


@pytest.mark.parametrize(
    ("slip", "effects", "names"),
    [
        ((0.0, 0.0), Effects(drilling=0.03), ("theta_dot", "phi")),
        ((0.1, 0.05), Effects(mu=0.2), ("theta_dot", "psi_dot")),
    ],
    ids=["a turning comes to rest", "a slip comes to rest"],
)
def test_a_motion_that_comes_to_rest_on_the_way(
    slip: tuple[float, float], effects: Effects, names: tuple[str, ...]
) -> None:
    """To 1e-9: the law changes, and the disturbance with it, at that instant and not behind it."""
    problem = Problem(parameters=PAPER_CAN, effects=effects, slip=slip, **ROCK)
    pieces = path_of(problem).pieces
    modes = [(piece.mode.slips, piece.mode.turns) for piece in pieces]
    assert len({*modes}) == 2
    hold_differences(problem, names, 1e-9)


@pytest.mark.parametrize(
    ("theta_dot", "contour", "senses"),
    [(0.05, 2e-3, [1, -1, 1]), (0.0, 5e-3, [0, -1]), (0.05, 0.02, [1, -1, 0])],
    ids=["turns round twice", "is held at the release", "comes to rest"],
)
def test_a_contact_point_on_the_rim(theta_dot: float, contour: float, senses: list[int]) -> None:
    """To 1e-9, and to 1e-8 where what is held lets go, which it does 2e-9 beyond its limit."""
    rock = ROCK | {"theta_dot": theta_dot}
    problem = Problem(parameters=PAPER_CAN, effects=Effects(contour=contour), **rock)
    runs = [piece.mode.runs for piece in path_of(problem).pieces]
    assert [each for each, before in zip(runs, [None, *runs], strict=False) if each != before] == (
        senses
    )
    names = ("phi", "psi_dot", "a", "h", "contour_friction.coulomb")
    hold_differences(problem, names, 1e-9 if senses[0] else 1e-8)


# without a turning about the normal, to round-off
HELD = {"theta_dot": -ROCK["psi_dot"] / math.cos(ROCK["phi"])}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effects", "release", "phases", "names", "least"),
    [
        (
            Effects(mu=0.3, patch=0.02),
            {},
            ["slip"],
            ("phi", "a", "h", "slip.mu", "slip.patch"),
            1e-9,
        ),
        (
            Effects(mu=0.6, patch=0.1),
            {},
            ["slip", "stick"],
            ("phi", "theta_dot", "slip.mu", "slip.patch"),
            1e-9,
        ),
        # it lets go 2e-9 beyond its limit; where it all but slides the largest friction is measured
        # to 1e-12, for a step of 3e-5
        (
            Effects(mu=0.25, patch=0.1),
            HELD,
            ["stick", "slip"],
            ("slip.mu", "slip.patch"),
            (1e-8, 1e-7),
        ),
        # the friction jumps, and is largest just before
        (
            Effects(mu=0.2, mu_static=0.25, patch=0.1),
            HELD,
            ["stick", "slip"],
            ("a", "h", "slip.mu", "slip.mu_static", "slip.patch"),
            1e-8,
        ),
        # it is largest later
        (
            Effects(mu=0.3, mu_static=0.35, patch=0.02),
            HELD,
            ["stick", "slip"],
            ("a", "slip.mu", "slip.mu_static", "slip.patch"),
            1e-8,
        ),
    ],
    ids=["creeps", "comes to rest", "lets go", "lets go with a jump", "jumps, and is faster later"],
)
def test_a_patch_of_contact(
    effects: Effects,
    release: dict[str, float],
    phases: list[str],
    names: tuple[str, ...],
    least: float | tuple[float, float],
) -> None:
    problem = Problem(parameters=PAPER_CAN, effects=effects, **(ROCK | release))
    assert [phase.kind.value for phase in solve(problem).phases] == phases
    hold_differences(problem, names, least)


@pytest.mark.parametrize("static", [0.35, 0.38])
def test_a_static_friction_that_lets_go(static: float) -> None:
    """The force jumps, at an instant that moves; it lets go 2e-9 beyond its limit."""
    effects = Effects(mu=0.3, mu_static=static)
    problem = Problem(parameters=PAPER_CAN, effects=effects, **ROCK)
    assert [phase.kind.value for phase in solve(problem).phases][:2] == ["stick", "slip"]
    hold_differences(problem, ("phi", "theta_dot", "a", "slip.mu", "slip.mu_static"), 1e-8)
    known = sensitivity(problem)
    assert known.values["peak_friction_ratio"] == static
    assert known.derivatives["peak_friction_ratio"][known.by.index("slip.mu_static")] == 1.0


def test_one_that_only_slips_has_the_derivatives_of_a_lesser_static_friction() -> None:
    known, plain = (
        sensitivity(Problem(parameters=PAPER_CAN, effects=effects, **ROCK))
        for effects in (Effects(mu=0.1, mu_static=0.13), Effects(mu=0.1))
    )
    for name in QUANTITIES:
        own = known.derivatives[name].tolist()
        assert own.pop(known.by.index("slip.mu_static")) == 0.0
        assert own == plain.derivatives[name].tolist()


def hold_differences(
    problem: Problem, names: tuple[str, ...], least: float | tuple[float, float]
) -> None:
    """Hold derivatives to a share of what a change of a number by itself does, by differences.

    Of two shares the second is that of the largest friction.
    """
    known = sensitivity(problem)
    share, of_friction = least if isinstance(least, tuple) else (least, least)
    leasts = [of_friction if name == "peak_friction_ratio" else share for name in QUANTITIES]
    assert not known.why
    for name in names:
        # a coefficient of friction along the rim is small itself
        step = 2e-6 if name == "contour_friction.coulomb" else 3e-5
        values = [measured(varied(problem, name, k * step)) for k in (-2, -1, 1, 2)]
        differences = (8 * (values[2] - values[1]) - (values[3] - values[0])) / (12 * step)
        slopes = [known.derivatives[each][known.by.index(name)] for each in QUANTITIES]
        sizes = np.abs(slopes) + np.abs([known.values[each] for each in QUANTITIES])
        assert (np.abs(differences - slopes) / sizes < leasts).all(), name


def path_of(problem: Problem) -> SegmentsPath:
    path = solve(problem).path
    assert isinstance(path, SegmentsPath)
    return path


def test_a_plane_that_never_slips_gives_the_derivatives_of_rolling() -> None:
    rolling = sensitivity(Problem(parameters=PAPER_CAN, **ROCK))
    rough = sensitivity(Problem(parameters=PAPER_CAN, effects=Effects(mu=1.0), **ROCK))
    for name in QUANTITIES:
        ideal, own = rolling.derivatives[name], rough.derivatives[name]
        assert own[:-1] == pytest.approx(ideal, rel=1e-9, abs=1e-11), name
        assert own[-1] == 0.0


def test_the_friction_of_a_rim_that_slips_is_the_coefficient() -> None:
    own = sensitivity(Problem(parameters=PAPER_CAN, effects=Effects(mu=0.3), **ROCK))
    expected = [float(name == "slip.mu") for name in own.by]
    assert own.derivatives["peak_friction_ratio"].tolist() == expected


def test_what_has_no_derivative_says_why() -> None:
    flat = Problem(parameters=PAPER_CAN, phi=0.3, bounces=1)
    own = sensitivity(flat)
    assert set(own.why) == set(QUANTITIES)
    assert all("no bounce" in sentence for sentence in own.why.values())
    assert all(np.isnan(slope).all() for slope in own.derivatives.values())
    pulled = sensitivity(
        Problem(parameters=PAPER_CAN, phi=0.3, phi_dot=0.2, psi_dot=0.12, theta_dot=0.4, bounces=1)
    )
    assert pulled.why == {"peak_friction_ratio": PULLED}
    assert np.isfinite(pulled.derivatives["period"]).all()


def test_a_constant_at_its_bound_has_derivatives_of_one_side() -> None:
    at_bound = Problem(parameters=PAPER_CAN, effects=Effects(angular_damping=0.01), **ROCK)
    said = sensitivity(at_bound).caveats[-1]
    assert "effects.damping.linear" in said
    assert "effects.damping.angular" not in said


def test_a_release_at_rest_has_the_derivatives_of_a_whole_bounce() -> None:
    """And one that hardly falls those of the bounce that it opens itself."""
    problem = Problem(parameters=PAPER_CAN, **ROCK)
    own = sensitivity(problem)
    place = own.by.index("phi_dot")
    assert own.derivatives["period"][place] == 0.0
    assert "at rest" in own.caveats[0]
    falling = sensitivity(replace(problem, phi_dot=-1e-9))
    phi, psi_dot = np.array(problem.phi), np.array(problem.psi_dot)
    spin = psi_dot + problem.theta_dot
    fall = -float(nutation_acceleration(phi, psi_dot, spin, PAPER_CAN))
    assert falling.derivatives["period"][place] == pytest.approx(1 / fall, rel=1e-6)
    assert falling.caveats == ()


def test_a_solution_has_its_derivatives() -> None:
    solution = solve(Problem(parameters=PAPER_CAN, **ROCK))
    own = solution.sensitivity
    assert own.values["angle_of_turn"] == pytest.approx(
        solution.bounces[0].angle_of_turn, rel=1e-12
    )
