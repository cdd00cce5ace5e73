"""Results are the same bits whatever the number of threads of the linear algebra."""

import os
import subprocess
import sys

import pytest

PROGRAM = """
import hashlib
import numpy as np
from reference import PAPER_CAN, Problem, exact_bounces, solve

digest = hashlib.sha256()
release = {"phi": 0.3, "psi_dot": 0.05, "theta_dot": 0.1, "phi_dot": -0.2}
for model in ("auto", "rolling"):
    found = solve(
        Problem(parameters=PAPER_CAN, bounces=40, **release),
        model=model,
        outputs={"contact_locus"},
    )
    states = found.at(np.linspace(0.0, found.t_end, 3000))
    for name in ("phi", "phi_dot", "psi", "theta", "psi_dot", "x", "y"):
        digest.update(getattr(states, name).tobytes())
    digest.update(repr(found.bounces).encode())
random = np.random.default_rng(0)
a = 10.0 ** random.uniform(-1.0, 1.0, 3000)
for can in ({"a": a, "c": a, "h": a[::-1]}, {"a": 0.7, "c": 0.6, "h": 1.5}):
    cycles = exact_bounces(
        **can,
        phi=random.uniform(0.01, 0.6, a.size),
        psi_dot=random.normal(size=a.size),
        theta_dot=random.normal(size=a.size),
    )
    for name in ("code", "period", "angle_of_turn", "phi_min", "peak_psi_dot"):
        digest.update(getattr(cycles, name).tobytes())
print(digest.hexdigest())
"""
LIBRARIES = ("OPENBLAS", "OMP", "MKL", "BLIS", "VECLIB")


def digest_with(threads: int) -> str:
    number = {f"{name}_NUM_THREADS": str(threads) for name in LIBRARIES}
    return subprocess.run(  # noqa: S603 - our own program
        [sys.executable, "-c", PROGRAM],
        env=os.environ | number,
        capture_output=True,
        text=True,
        check=True,
    ).stdout


@pytest.mark.slow
def test_one_thread_and_several_give_the_same_bits() -> None:
    assert len(digest_with(1)) == 65
    assert digest_with(1) == digest_with(2)
