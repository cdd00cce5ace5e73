"""Engines by name, as what the tests need of them."""

from typing import Any

from harness.core.case import Case
from harness.engines.description import Method, Precision
from harness.engines.registry import (
    description_of,
    engine,
    is_constraint,
    not_installed,
    our_names,
)
from harness.engines.stepping.physics_engine import PhysicsEngine

PHYSICS = tuple(name for name in our_names() if name != "reference")
"""Engines of this project that move a world; the tests of one that is not installed are skipped."""

STEPPING = tuple(n for n in PHYSICS if description_of(n).method is not Method.ERROR_CONTROL)
"""Those of them that take a timestep."""

INSTALLED = tuple(name for name in STEPPING if name not in not_installed())


def stepping_engine(name: str) -> PhysicsEngine[Any]:
    """Return an engine that steps a world."""
    found = engine(name)
    assert isinstance(found, PhysicsEngine)
    return found


CONTACTS = tuple(name for name in STEPPING if not is_constraint(name))
"""Those of them that find a contact, and impose no rolling."""

DOUBLE = tuple(name for name in STEPPING if description_of(name).precision is Precision.DOUBLE)
"""Those that compute in double precision, in which a law holds to round-off."""

CONSTRAINT = next(filter(is_constraint, our_names()))
"""An engine that imposes rolling; its description needs no package."""


def imposed(case: Case) -> set[str]:
    """Return the rows of parity in which the engine of a case goes its own way in it."""
    return set(stepping_engine(case.engine).imposed_in(case))
