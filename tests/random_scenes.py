"""A thousand random scenes of each kind of contact: ``make random-scenes``.

``python -m tests.random_scenes`` prints which of them fail and why. The tests take a sample, for
all of them take three quarters of an hour of a processor.
"""

import sys
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from types import MappingProxyType

import numpy as np

from tests.reference import test_random_laws, test_random_soft_scenes
from tests.reference.unilateral import test_random_scenes
from tests.support.soft_contact import random_problem

SCENES = 1000


def rolling(number: int) -> str:
    """Return what is wrong with a can that stays on the plane; nothing if nothing is."""
    return test_random_laws.fault_of(test_random_laws.drawn(number).problem)


def compliant(number: int) -> str:
    """Return what is wrong with a can on a contact that gives way."""
    return test_random_soft_scenes.fault_of(random_problem(number))


def unilateral(number: int) -> str:
    """Return what is wrong with a can that leaves the plane and lands."""
    try:
        test_random_scenes.check(SCENES + number)
    except (AssertionError, ArithmeticError, np.linalg.LinAlgError, ValueError) as error:
        return f"{type(error).__name__}: {error}".partition("\n")[0]
    return ""


KINDS: Mapping[str, Callable[[int], str]] = MappingProxyType(
    {"rolling": rolling, "compliant": compliant, "unilateral": unilateral}
)


def main() -> int:
    """Solve all of them, and say which fail."""
    count = 0
    with ProcessPoolExecutor() as pool:
        for kind, fault_of in KINDS.items():
            faults = pool.map(fault_of, range(SCENES), chunksize=10)
            found = {number: fault for number, fault in enumerate(faults) if fault}
            print(f"{kind}: {len(found)} of {SCENES} fail")  # noqa: T201 - what it is for
            for number, fault in found.items():
                print(f"  {number}: {fault}")  # noqa: T201
            count += len(found)
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
