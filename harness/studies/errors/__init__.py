"""The study of the three errors: model form, discretisation, solver; and what is not decidable."""

from harness.studies.errors.plan import Plan, design, plan
from harness.studies.errors.reading import ThreeErrors, read, three_errors

__all__ = ["Plan", "ThreeErrors", "design", "plan", "read", "three_errors"]
