"""What engines that step a world share: schedule, settling, recording, horizon."""

from typing import TYPE_CHECKING

from harness.core.public_paths import warn_renamed

if TYPE_CHECKING:
    from harness.engines.stepping.physics_engine import PhysicsEngine

__all__ = ["PhysicsEngine"]


def __getattr__(name: str) -> object:
    """Return `PhysicsEngine`, which this path had in the previous release, with a warning."""
    if name != "PhysicsEngine":
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    from harness.engines.stepping import physics_engine  # noqa: PLC0415 - only for old adapters

    warn_renamed(f"import '{name}' from 'harness.engines'; this path goes with the next release")
    return physics_engine.PhysicsEngine
