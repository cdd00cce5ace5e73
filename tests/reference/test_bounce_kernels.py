"""The compiled kernel of the exact bounce against the arrays, and what it leaves to them."""

import json
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from reference import PAPER_CAN, Outcome, exact_bounces
from reference.integrable.bounce_kernels import FIELDS, LEFT, solve_each
from reference.integrable.turning_points import OUTCOMES
from tests.reference.hostile.campaign import AGREED

ROWS = 4000
CAN: dict[str, Any] = {name: np.array([getattr(PAPER_CAN, name)]) for name in "ach"}


def releases(n: int) -> dict[str, Any]:
    """Return releases from gentle to hard, half of them at rest."""
    rng = np.random.default_rng(5)
    return {
        "phi": rng.uniform(0.02, 0.6, n),
        "phi_dot": rng.choice([0.0, 1.0], n) * rng.uniform(-0.4, 0.4, n),
        "psi_dot": rng.normal(size=n) * 10.0 ** rng.uniform(-6, 0.5, n),
        "theta_dot": rng.normal(size=n) * 10.0 ** rng.uniform(-6, 0.5, n),
    }


def cans(n: int) -> dict[str, Any]:
    """Return cans from flat to slender."""
    rng = np.random.default_rng(6)
    a = 10.0 ** rng.uniform(-0.7, 0.7, n)
    return {"a": a, "c": a * rng.uniform(0.2, 1.9, n), "h": 10.0 ** rng.uniform(-0.5, 0.7, n)}


@pytest.mark.parametrize("many", [False, True], ids=["one can", "many cans"])
def test_the_kernel_finds_what_the_arrays_find(*, many: bool) -> None:
    given, owners = releases(ROWS), cans(ROWS) if many else CAN
    numbers, code = solve_each(tuple(owners.values()), tuple(given.values()))
    solved = code == OUTCOMES.index(Outcome.FINISHED)
    known = exact_bounces(**owners, **given)
    # at rest and moving alike, most of those that bounce; none that does not
    for of in (given["phi_dot"] == 0.0, given["phi_dot"] != 0.0):
        assert solved[of & known.bounced].mean() > 0.8
    assert (code[code != LEFT] == known.code[code != LEFT]).all()
    assert (code == OUTCOMES.index(Outcome.OVERTURNED)).sum() > ROWS / 20
    truth = np.stack([getattr(known, name) for name in FIELDS], axis=1)[solved]
    apart = np.abs(numbers[solved] / truth - 1)
    # beside a separatrix and where the first integral B cancels the numbers given allow more
    assert apart.max() < AGREED
    assert np.quantile(apart.max(axis=1), 0.98) < 1e-13


def test_a_release_has_the_same_bits_alone_and_among_others() -> None:
    n = 60
    given, owners = releases(n), cans(n)
    owners = {name: np.repeat(values[::3], 3) for name, values in owners.items()}
    numbers, code = solve_each(tuple(owners.values()), tuple(given.values()))
    solved = code == OUTCOMES.index(Outcome.FINISHED)
    assert solved.sum() > n / 3
    for row in np.flatnonzero(solved):
        one = slice(row, row + 1)
        alone, _ = solve_each(
            tuple(values[one] for values in owners.values()),
            tuple(values[one] for values in given.values()),
        )
        assert alone.tobytes() == numbers[one].tobytes()
    backwards, _ = solve_each(
        tuple(values[::-1] for values in owners.values()),
        tuple(values[::-1].copy() for values in given.values()),
    )
    assert backwards[::-1].tobytes() == numbers.tobytes()


def test_what_the_kernel_leaves_is_solved_by_the_arrays() -> None:
    """One release that the kernel solves, between ones that it leaves: bits of either path."""
    balance = PAPER_CAN.balancing_angle
    phi, psi_dot = [0.4, balance - 1e-9, 0.3, 0.8], [0.0, 1e-12, 0.02, 0.01]
    given: dict[str, Any] = {"phi": np.array(phi), "psi_dot": np.array(psi_dot)}
    found = exact_bounces(**CAN, **given, compiled=True)
    endings = (Outcome.FELL_FLAT, Outcome.FINISHED, Outcome.FINISHED, Outcome.OVERTURNED)
    assert [OUTCOMES[code] for code in found.code] == list(endings)
    left = [0, 1]
    known = exact_bounces(**CAN, phi=given["phi"][left], psi_dot=given["psi_dot"][left])
    for name in FIELDS:
        assert getattr(found, name)[left].tobytes() == getattr(known, name).tobytes()
    kernel, code = solve_each(
        tuple(CAN.values()), (given["phi"], np.zeros(4), given["psi_dot"], np.zeros(4))
    )
    assert (code == LEFT).tolist() == [True, True, False, False]
    assert code[2:].tolist() == found.code[2:].tolist()
    assert [getattr(found, name)[2] for name in FIELDS] == kernel[2].tolist()


WITHOUT = """
import importlib.util, json, sys
from reference import PAPER_CAN, exact_bounces
find = importlib.util.find_spec
import reference.numerics.compiled as compiled
compiled.find_spec = lambda name: None if name == "numba" else find(name)
release = dict(a=PAPER_CAN.a, c=PAPER_CAN.c, h=PAPER_CAN.h, phi=0.3, psi_dot=0.01)
period = exact_bounces(**release).period[0]
told = [compiled.available(), "numba" in sys.modules, period > 0]
try:
    exact_bounces(**release, compiled=True)
except ModuleNotFoundError as error:
    told += [str(error), error.name]
print(json.dumps(told, default=bool))
"""


def test_without_numba_the_arrays_solve_and_kernels_are_refused() -> None:
    done = subprocess.run(  # noqa: S603 - our own program
        [sys.executable, "-c", WITHOUT], capture_output=True, text=True, check=True
    )
    available, imported, solved, message, missing = json.loads(done.stdout)
    assert (available, imported, solved, missing) == (False, False, True, "numba")
    assert message == "compiled kernels need numba: pip install 'rockingcan[fast]'"
