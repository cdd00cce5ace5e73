"""Tasks in processes of their own, within limits; a task that dies takes nothing with it."""

from harness.isolation.beside import beside, end_beside
from harness.isolation.inside import inside
from harness.isolation.limits import NO_LIMITS, Limits
from harness.isolation.loss import Loss, LostTaskError
from harness.isolation.pool import Isolated
from harness.isolation.serving import is_worker

__all__ = [
    "NO_LIMITS",
    "Isolated",
    "Limits",
    "Loss",
    "LostTaskError",
    "beside",
    "end_beside",
    "inside",
    "is_worker",
]
