"""What wrong use of the gate raises."""

from harness.errors import HarnessError


class BaselineError(HarnessError, ValueError):
    """Accepted results, or a report, cannot be read or do not fit what they are held against."""
