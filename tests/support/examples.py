"""How many examples a property test draws."""

from hypothesis import settings


def examples(share: float) -> int:
    """Return a share of the examples of the profile in force, for tests of another cost each."""
    return int(settings().max_examples * share)
