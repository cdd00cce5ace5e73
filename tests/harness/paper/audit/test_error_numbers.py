"""Each number typed into the list of errors is one that the paper prints or that is computed here.

Of the errors that change numbers or conclusions, and of the wrong mass, every decimal and every
number of three digits has an entry; of the other errors those that are neither.
"""

import math
import re
from functools import cache

import mpmath as mp
import numpy as np
import pytest
import sympy as sp

from harness.paper import release
from harness.paper.audit import paper_can
from harness.paper.audit.checks.friction import DISK, LOW, LOW_RATE, RATES, disk_bounce
from harness.paper.audit.checks.momenta import fall
from harness.paper.audit.checks.numbers import SQUARE, predicted_peak, rounded_peaks
from harness.paper.audit.checks.outer import CLOSED_FORMS, time
from harness.paper.audit.checks.panels import PANELS, constants_of
from harness.paper.audit.checks.steady_motions import CRITICAL, PRINTED_CRITICAL
from harness.paper.audit.claims import CLAIMS, ERRORS, PaperError, Weight
from harness.paper.audit.evidence import Number
from harness.paper.audit.flat_motion import exact_constants
from harness.paper.audit.symbols import CAN
from reference import PAPER_CAN, Parameters
from reference.asymptotic.expansions import paper_constants
from reference.asymptotic.small_nutation import reduced_equation
from reference.problem.states import initial_states

ERROR = {error.name: error for error in ERRORS}
COUNTED = [error for error in ERRORS if error.weight is Weight.SUBSTANTIAL or error.name == "mass"]
_NUMBER = re.compile(r"(?<![\w.(])\d+(?:\.\d+)?(?:e-?\d+)?")
_REFERENCE = re.compile(r"\(\d\.\d+[a-f]?\)|fig01:\w+|\^\([^)]*\)")
PRINTED = {
    "units of eps and zeta": ("1.43e-10", "0.40"),
    "mass": ("0.043",),
    "unit of the release": ("0.1001", "0.1000"),
    "exchanged peaks": ("3.5", "3449"),
    "height of the cylinder": ("0.96", "0.48", "1.473"),
    "large eps in panels c) and d)": ("1e-8", "4e-6"),
}
"""Numbers of the paper, or those from which others are computed."""
GROUPS = (
    PAPER_CAN,
    Parameters(
        a=float(paper_can.MOMENT_A / SQUARE), c=float(paper_can.MOMENT_C / SQUARE), h=PAPER_CAN.h
    ),
)
"""The printed groups, and those that the printed moments have with the one mass that fits."""


@cache
def bounds() -> dict[str, dict[str, tuple[float, float]]]:
    """Return by the name of the error each bound typed there, between what has to lie around it."""
    posed = release.problem(PANELS["d"][0], theta_dot=PANELS["d"][1], bounces=1)
    found = [paper_constants(initial_states(posed), group) for group in GROUPS]
    eps = [float(two[0]) ** 2 for _, two in found]
    zetas = [abs(float(zero[0] / two[0])) for zero, two in found]
    least, most = rounded_peaks()
    return {
        "large eps in panels c) and d)": {
            "1e-12": (max(eps), constants_of("a")["eps"]),
            "1e5": (1e4, min(zetas)),
        },
        "exchanged peaks": {"3575": (float(least), float(most))},
    }


def _turn(a_p: mp.mpf) -> mp.mpf:
    return mp.degrees(mp.pi * mp.sqrt((a_p + 1) / a_p))


@cache
def computed() -> dict[str, dict[str, object]]:
    """Return by the name of the error each number typed there with its value."""
    p = paper_can
    zero, two = exact_constants()
    bounce = release.bounce().bounces[0]
    mass = mp.mpf("0.043") * p.RADIUS**2
    a, c = p.MOMENT_A / mass, p.MOMENT_C / mass
    axis = fall()["H_z^B"]
    frictions = [disk_bounce(rate, release.PHI)[1] for rate in RATES]
    panels = {name: constants_of(name) for name in PANELS}
    spins = {name: float(p.c) * sum(PANELS[name]) * release.SECOND for name in "cd"}
    zetas = {name: np.sqrt(x["B_0^2"] / x["eps"]) for name, x in panels.items()}
    critical, printed = (mp.sqrt(mp.mpmathify(x.subs(CAN))) for x in (CRITICAL, PRINTED_CRITICAL))
    _, friction = disk_bounce(LOW_RATE, LOW)
    return {
        "mass": {
            "0.070": SQUARE / p.RADIUS**2,
            "1.184": a,
            "1.001": c,
            "205": _turn(a + p.h**2),
            "0.439": p.h / (a + p.h**2),
        },
        "units of eps and zeta": {
            "3.76e-11": two**2,
            "0.669": zero / abs(two),
            "8.1e-5": mp.sqrt(mp.mpf("1.43e-10") * p.a_p / p.WIDTH),
            "4.2e-5": bounce.phi_min,
        },
        "unit of the release": {
            "0.006148": mp.mpf("0.1001") * p.SECOND,
            "0.006141": mp.mpf("0.1") * p.SECOND,
        },
        "exchanged peaks": {
            "3576": predicted_peak(),
            "3449": bounce.peak_psi_dot,
            "3.7": 100 * (predicted_peak() / bounce.peak_psi_dot - 1),
        },
        "height of the cylinder": {"0.866": mp.sqrt(3) / 2, "0.433": mp.sqrt(3) / 4},
        "friction at small a_p": {
            "0.1": RATES[0],
            "0.001": RATES[-1],
            "0.005": LOW_RATE,
            "100": math.pi / release.PHI,
            "1000": math.pi / LOW,
            "402": _turn(mp.mpf(DISK.a)),
            "0.17": min(frictions),
            "0.24": max(frictions),
            "0.02": friction,
            "0.51": bounce.peak_friction_ratio,
        },
        "logarithm of Theta + Psi": {"1.9e-6": axis[0], "5.3e-6": -axis[1]},
        "large eps in panels c) and d)": {
            "2.4e-9": panels["c"]["eps"],
            "3.8e-11": panels["a"]["eps"],
            "1.9e3": zetas["c"],
            "0.29": spins["c"],
            "0.33": spins["d"],
            "63": panels["c"]["eps"] / panels["a"]["eps"],
        },
        "stability of straight rolling": {"1.090": critical, "0.994": printed},
        "constants of integration": {
            shown: sp.N(CLOSED_FORMS[name].subs(time, 0), 20)
            for name, shown in (("J_l2", "0.27095"), ("J_l1", "0.72461"), ("J_ll", "2.89845"))
        },
        "c_p": {"1.615": p.c_p, "1.6147": p.MOMENT_C / SQUARE + 1},
    }


def words(error: PaperError) -> str:
    """Return what is typed about an error, without references and exponents."""
    return _REFERENCE.sub("", f"{error.printed} | {error.right} | {error.changes}")


@pytest.mark.parametrize("error", COUNTED, ids=[error.name for error in COUNTED])
def test_every_number_of_a_grave_error_has_an_entry(error: PaperError) -> None:
    known = {
        *computed().get(error.name, {}),
        *PRINTED.get(error.name, ()),
        *bounds().get(error.name, {}),
    }
    for number in _NUMBER.findall(words(error)):
        if "." in number or "e" in number or len(number) > 2:
            assert number in known, f"{number} in {words(error)}"


@pytest.mark.parametrize("name", list(computed()))
def test_a_typed_number_is_what_is_computed(name: str) -> None:
    for typed, value in computed()[name].items():
        assert typed in words(ERROR[name]), typed
        assert Number(printed=typed, value=value, source="").near(), (typed, value)


def test_a_typed_bound_is_one() -> None:
    for name, limits in bounds().items():
        for typed, (low, high) in limits.items():
            assert typed in words(ERROR[name]), typed
            assert low < float(typed) < high, typed


def test_an_altered_number_is_refused() -> None:
    for numbers in computed().values():
        for typed, value in numbers.items():
            places = typed.partition("e")[0]
            digit = str((int(places[-1]) + 3) % 10)
            other = places[:-1] + digit + typed[len(places) :]
            assert not Number(printed=other, value=value, source="").near(), other


def test_a_printed_number_is_printed() -> None:
    text = " ".join(claim.printed for claim in CLAIMS)
    for number in ("0.1001", "0.1000", "3575", "3449", "0.96", "0.48"):
        assert number in text


def test_what_words_say_of_numbers() -> None:
    """Sixteen and six times, two contours of six, and the least eps of all."""
    p = paper_can
    assert round(float(1 / p.SECOND)) == 16
    assert round(float((p.c_p + p.h**2) / p.c)) == 6
    panels = [constants_of(name)["eps"] for name in PANELS]
    assert constants_of("d")["eps"] == min(panels)
    assert DISK.a == DISK.c / 2 == 0.25
    two = math.sqrt(1.43e-10)
    least = reduced_equation(PAPER_CAN, 0.40 * two, two).potential(np.geomspace(1e-5, 1e-2, 4000))
    assert sum(energy < least.min() for energy in (7.5e-4, 1e-3, 2e-3, 3e-3, 4e-3, 5e-3)) == 2
