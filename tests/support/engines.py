"""Engines by name, as what the tests need of them."""

from typing import Any

from harness.engines.registry import engine
from harness.engines.stepping.physics_engine import PhysicsEngine


def stepping_engine(name: str) -> PhysicsEngine[Any]:
    """Return an engine that steps a world."""
    found = engine(name)
    assert isinstance(found, PhysicsEngine)
    return found
