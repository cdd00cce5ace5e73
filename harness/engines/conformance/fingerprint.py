"""A simulation's outcome and every bit of its trajectory, in a line of text.

`python -m harness.engines.conformance.fingerprint ENGINE` prints that of the suite's brief release:
what a fresh process makes of a case.
"""

import hashlib
import sys
from dataclasses import fields

from harness.core.simulation import Simulation
from harness.core.trajectory import Trajectory
from harness.engines.conformance.fixture import Fixture
from harness.engines.registry import engine


def fingerprint(simulation: Simulation) -> str:
    """Return a line that differs where a bit differs; times and cost are not in it."""
    digest = hashlib.sha256()
    if simulation.trajectory is not None:
        for field in fields(Trajectory):
            digest.update(getattr(simulation.trajectory, field.name).tobytes())
    return f"{simulation.outcome.name} {simulation.steps} {digest.hexdigest()}"


def main(name: str) -> str:
    """Return the fingerprint of a registered engine's run of the brief release."""
    bench = Fixture(engine(name))
    return fingerprint(bench.run(bench.case(bench.brief)))


if __name__ == "__main__":
    sys.stdout.write(main(sys.argv[1]) + "\n")
