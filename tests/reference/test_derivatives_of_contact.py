"""Derivatives through a contact that gives way, through flights and through impacts.

Against extrapolated differences of whole motions, which know nothing of variational equations; and
against the rigid contact that a stiff one approaches.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from reference import (
    PAPER_CAN,
    Compliance,
    Effects,
    Gravity,
    Mass,
    Problem,
    Restitution,
    solve,
)
from reference.analysis.nutation_tangents import nutation_tangents
from reference.analysis.release_tangents import HELD
from reference.analysis.sensitivity import sensitivity
from reference.analysis.unilateral_tangents import FACE, UnilateralEquations, with_flights
from reference.equations.contact_laws import Kind
from reference.equations.state_vector import LEAN, TIME, TURN, Angles
from reference.integrable.derivatives import QUANTITIES
from reference.problem.states import Floats
from reference.unilateral.free_body import axes_of_b, on_rim
from reference.unilateral.path import FlightPath, UnilateralPath
from tests.reference.unilateral.test_random_scenes import drawn
from tests.support.varied import varied

ROCK = Problem(parameters=PAPER_CAN, phi=0.4, psi_dot=0.123, theta_dot=-0.0614, bounces=1)
THROWN = replace(ROCK, psi_dot=0.5, theta_dot=3.0, phi_dot=1.5)
SOFT = Compliance(stiffness=1e3, damping=20.0)
YIELDING = Compliance(stiffness=1e2, damping=8.0)
STILL = replace(ROCK, psi_dot=0.0, theta_dot=0.0)
HERTZ = Compliance(stiffness=1e4, damping=2e3, exponent=1.5)
BESIDE = Mass(share=0.3, x=0.3, y=0.4, z=0.1)
MASS = Mass(share=0.1, x=0.3, y=0.1, z=0.1)
SHAKE = Gravity(amplitude=(0.06, 0.02, 0.2), rate=1.5, phase=0.3)


def with_effects(problem: Problem, height: float = 0.0, **effects: object) -> Problem:
    return replace(problem, height=height, effects=Effects(**effects))  # type: ignore[arg-type]


def dropped(problem: Problem = ROCK, **effects: object) -> Problem:
    return with_effects(problem, 0.01, **effects)


# a release that begins to slip at once, touches and flights, impacts that end in finite time
CASES = {
    "soft, sticks": with_effects(ROCK, compliance=SOFT),
    "soft, flies and slips": with_effects(THROWN, mu=0.3, compliance=replace(SOFT, damping=5.0)),
    "impact, slips": with_effects(THROWN, mu=0.3, restitution=Restitution(coefficient=0.5)),
    "impacts, stick": dropped(restitution=Restitution(coefficient=0.3)),
}
SLOW_CASES = {
    "soft, slips": with_effects(ROCK, mu=0.12, compliance=SOFT),
    "soft, dropped, sticks": dropped(compliance=YIELDING),
    "soft after Hertz": with_effects(ROCK, compliance=HERTZ),
    "soft, slips from a release that moves": with_effects(
        replace(ROCK, phi_dot=0.1), mu=0.1, compliance=SOFT, mass=MASS
    ),
    "soft, dropped, slips and sticks": dropped(mu=0.3, compliance=YIELDING),
    "impacts after Poisson": dropped(
        replace(ROCK, psi_dot=0.4),
        mu=0.2,
        restitution=Restitution(coefficient=0.2, law="poisson"),
    ),
    "impacts, slip and stick": dropped(mu=0.3, restitution=Restitution(coefficient=0.3)),
    "soft, a release that falls a little and then rises": with_effects(
        replace(ROCK, phi=0.8, psi_dot=3.0, theta_dot=0.0, phi_dot=-0.02), compliance=SOFT
    ),
    "soft, a patch that lifts": with_effects(
        replace(ROCK, psi_dot=0.5, theta_dot=1.0), mu=0.2, patch=0.1, compliance=YIELDING
    ),
    "impacts without friction, after Poisson": dropped(
        replace(ROCK, psi_dot=0.4), mu=0.0, restitution=Restitution(coefficient=0.5, law="poisson")
    ),
    "an impact that ends the bounce": replace(drawn(8), duration=None, bounces=1),
    "no restitution, point mass, shaken": dropped(
        mu=0.3, mass=MASS, gravity=SHAKE, restitution=Restitution(coefficient=0.0)
    ),
}


def measured(problem: Problem) -> Floats:
    found = solve(problem)
    bounce = found.bounces[0]
    values = {name: getattr(bounce, name, None) for name in QUANTITIES}
    values["period"] = float(found.maxima[1] - found.maxima[0])
    return np.array([values[name] for name in QUANTITIES])


def differences(problem: Problem, name: str, size: float) -> tuple[Floats, Floats]:
    """Return extrapolated central differences, and how far from each other the last two are."""
    quotients = [
        (measured(varied(problem, name, h)) - measured(varied(problem, name, -h))) / (2 * h)
        for h in (size, size / 2, size / 4)
    ]
    one, two = ((4 * b - a) / 3 for a, b in pairwise(quotients))
    return (16 * two - one) / 15, np.abs(two - one)


def hold_against_differences(problem: Problem) -> None:
    own = sensitivity(problem)
    assert not own.why
    assert own.method == "variational equations"
    one_sided = " ".join(own.caveats)
    for place, name in enumerate(own.by):
        if f"effects.{name} " in one_sided:
            continue
        if name == "phi_dot" and "by the rate of phi" in one_sided:
            continue
        unit = _unit(problem, name)
        expected, apart = differences(problem, name, 2e-4 * unit)
        slopes = np.array([own.derivatives[quantity][place] for quantity in QUANTITIES])
        values = np.abs([own.values[quantity] for quantity in QUANTITIES])
        # of what a change of its own size does
        error = 1e-7 * (np.abs(expected) + values / unit) + apart
        assert (np.abs(slopes - expected) <= error).all(), (name, slopes, expected)


def _unit(problem: Problem, name: str) -> float:
    effect, _, key = name.partition(".")
    if effect == "compliance":
        return float(getattr(problem.effects.compliance, key))
    return problem.height if name == "height" else 1.0


@pytest.mark.parametrize("case", CASES.values(), ids=CASES.keys())
def test_differences_of_motions(case: Problem) -> None:
    hold_against_differences(case)


@pytest.mark.slow
@pytest.mark.parametrize("case", SLOW_CASES.values(), ids=SLOW_CASES.keys())
def test_differences_of_motions_with_more(case: Problem) -> None:
    hold_against_differences(case)


def test_cases_fly_land_slip_and_stick() -> None:
    kinds = {name: {phase.kind for phase in solve(case).phases} for name, case in CASES.items()}
    assert set().union(*kinds.values()) >= {Kind.FLIGHT, Kind.SLIP, Kind.STICK}
    # the bounce of a dropped can begins with a maximum of phi at the impact itself
    found = solve(CASES["impacts, stick"])
    assert found.maxima[0] == found.impacts[0].time
    assert any(impact.ends_at is not None for impact in found.impacts)


@pytest.mark.parametrize(("seed", "on_landing"), [(92, True), (162, False)])
def test_a_peak_that_the_contact_cuts_off_moves_with_it(seed: int, *, on_landing: bool) -> None:
    """Of the friction in a patch, largest just after the rim has landed, or before it lifts."""
    problem = replace(drawn(seed), duration=None, bounces=1)
    own, found = sensitivity(problem), solve(problem)
    rim = next(phase for phase in found.phases if phase.kind is Kind.SLIP and phase.start > 0)
    states = found.at(np.array([rim.start, rim.end - 1e-9]))
    assert states.force is not None
    ratios = np.hypot(states.force[:, 0], states.force[:, 1]) / states.force[:, 2]
    peak = own.values["peak_friction_ratio"]
    assert ratios[0 if on_landing else 1] == pytest.approx(peak, rel=1e-6)
    expected, _ = differences(problem, "c", 1e-5)
    slope = own.derivatives["peak_friction_ratio"][own.by.index("c")]
    place = QUANTITIES.index("peak_friction_ratio")
    assert slope == pytest.approx(expected[place], rel=1e-5, abs=0)


@pytest.mark.parametrize("drilling", [0.0, 0.1])
@pytest.mark.parametrize("name", ["psi_dot", "phi", "h"])
def test_what_sticks_at_a_touch_without_a_slip_stops_a_disturbance(
    name: str, drilling: float
) -> None:
    """A can that turns nowhere lands without a slip; a disturbance of it would slip, or turn."""
    problem = dropped(STILL, mass=BESIDE, drilling=drilling, compliance=YIELDING)
    own, place = sensitivity(problem), QUANTITIES.index("phi_min")
    assert any("dropped without turning" in caveat for caveat in own.caveats)
    size = 2e-5 if drilling else 2e-4
    expected, apart = differences(problem, name, size)
    slope = own.derivatives["phi_min"][own.by.index(name)]
    assert slope == pytest.approx(expected[place], rel=1e-5 if drilling else 1e-9, abs=0)
    assert apart[place] < 1e-5


def test_a_coefficient_at_its_bound_has_the_derivative_of_its_side() -> None:
    problem = SLOW_CASES["impacts without friction, after Poisson"]
    own = sensitivity(problem)
    assert any("effects.slip.mu" in caveat for caveat in own.caveats)
    here = measured(problem)
    one, two = ((measured(varied(problem, "slip.mu", h)) - here) / h for h in (1e-4, 5e-5))
    slopes = np.array([own.derivatives[name][own.by.index("slip.mu")] for name in QUANTITIES])
    assert slopes == pytest.approx(2 * two - one, rel=1e-4)


def test_what_friction_holds_after_an_impact_stops_a_disturbance() -> None:
    """A turning about the normal that drilling holds from the landing on, of one side."""
    light = Mass(share=0.05, x=0.3, y=0.4, z=0.1)
    none = Restitution(coefficient=0.0)
    problem = dropped(STILL, drilling=0.002, mass=light, restitution=none)
    times = np.array([1.5, 2.0])
    by, _, slopes = nutation_tangents(problem, times)
    until = replace(problem, bounces=None, duration=2.0)
    step = 1e-6
    moved = solve(varied(until, "psi_dot", step)).at(times).phi - solve(until).at(times).phi
    assert slopes[:, by.index("psi_dot")] == pytest.approx(moved / step, rel=1e-3)


def test_equal_coefficients_of_friction_have_one_side_each() -> None:
    own = sensitivity(with_effects(ROCK, mu=0.25, mu_static=0.25))
    slopes = own.derivatives["peak_friction_ratio"]
    assert slopes[own.by.index("slip.mu")] == 0.0
    assert slopes[own.by.index("slip.mu_static")] == 1.0
    assert any("not below the kinetic" in caveat for caveat in own.caveats)


def test_what_one_coefficient_lacks_is_said_of_it_alone() -> None:
    """The slip after the first impact is next to nothing, so that any friction would stop it."""
    release = replace(ROCK, phi_dot=0.05181514, psi_dot=0.05, theta_dot=17.81047862)
    own = sensitivity(dropped(release, mu=0.0, restitution=Restitution(coefficient=0.5)))
    of_mu = [own.derivatives[name][own.by.index("slip.mu")] for name in QUANTITIES]
    # a rim that slips takes the coefficient as the peak of its friction
    assert np.isnan(of_mu[:-1]).all()
    assert of_mu[-1] == 1.0
    assert np.isfinite([own.derivatives[name][0] for name in QUANTITIES]).all()
    (said,) = [sentence for sentence in own.caveats if "effects.slip.mu" in sentence]
    assert said.startswith("By effects.slip.mu there is no derivative of period, angle of turn")


def test_a_release_in_the_air_is_no_release_at_rest() -> None:
    """The bounce begins with the maximum at the impact, on both sides of a rate of zero."""
    caveats = sensitivity(CASES["impacts, stick"]).caveats
    assert not any("by the rate of phi" in caveat for caveat in caveats)
    rises = with_effects(replace(ROCK, phi=0.1, psi_dot=0.5, theta_dot=-3.5), linear_damping=0.01)
    assert solve(rises).maxima[0] > 0
    for problem in (CASES["soft, sticks"], rises):
        caveats = sensitivity(problem).caveats
        assert any("by the rate of phi" in caveat for caveat in caveats)


def test_a_stiff_contact_has_the_derivatives_of_a_rigid_one_at_first_order() -> None:
    rigid = sensitivity(with_effects(ROCK, linear_damping=0.01))
    off = []
    for stiffness in (1e4, 1e5):
        law = Compliance(stiffness=stiffness, damping=stiffness**0.5)
        own = sensitivity(with_effects(ROCK, linear_damping=0.01, compliance=law))
        assert own.by[: len(rigid.by)] == rigid.by
        off.append(
            [
                np.abs(own.derivatives[name][: len(rigid.by)] - rigid.derivatives[name]).max()
                / np.abs(rigid.derivatives[name]).max()
                for name in QUANTITIES
            ]
        )
    assert max(off[0]) < 0.05
    assert (np.array(off[1]) < 1.15 * np.array(off[0]) / 10).all()


def test_flights_are_integrated_as_their_closed_form_says() -> None:
    problem = SLOW_CASES["no restitution, point mass, shaken"]
    found = solve(problem)
    equations = UnilateralEquations(parameters=problem.parameters, effects=problem.effects)
    pieces = [piece for piece in with_flights(found, equations).pieces if piece.mode.flies]
    assert isinstance(found.path, UnilateralPath)
    flights = [part for part in found.path.parts if isinstance(part, FlightPath)]
    assert len(pieces) >= len(flights) > 0
    last = pieces[-1].end
    landing = flights[-1].landing()
    expected = on_rim(landing, flights[-1].flight.body)
    assert last[TIME] == pytest.approx(expected[TIME], rel=1e-14)
    assert last[TURN] == pytest.approx(expected[TURN], abs=1e-12)
    assert pytest.approx(Angles.of(expected[[LEAN]]).S, abs=1e-13) == Angles.of(last[[LEAN]]).S
    assert axes_of_b(last) == pytest.approx(axes_of_b(expected), abs=1e-12)
    # it meets the plane
    assert last[13] == pytest.approx(0.0, abs=1e-13)


def test_what_has_no_derivative_says_why() -> None:
    flat = dropped(
        STILL,
        mu=0.5,
        restitution=Restitution(coefficient=0.3),
    )
    held = with_effects(STILL, mu=0.5, drilling=0.1, mass=MASS, compliance=SOFT)
    jams = replace(drawn(60), duration=None, bounces=1)
    for problem, reason in ((flat, FACE), (jams, FACE), (held, HELD)):
        own = sensitivity(problem)
        assert own.method == "none"
        assert set(own.why.values()) == {reason}
        assert np.isnan(np.concatenate(list(own.derivatives.values()))).all()


def test_an_exponent_and_restitution_have_derivatives_where_their_law_goes_on() -> None:
    assert "compliance.exponent" in sensitivity(SLOW_CASES["soft after Hertz"]).by
    assert "compliance.exponent" not in sensitivity(CASES["soft, sticks"]).by
    none = dropped(restitution=Restitution(coefficient=0.0))
    assert "restitution.coefficient" not in sensitivity(none).by
    assert "restitution.coefficient" in sensitivity(CASES["impacts, stick"]).by
