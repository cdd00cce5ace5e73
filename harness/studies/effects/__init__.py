"""The effects study: which effects a scene needs, what each costs, what an engine adds unasked."""

from harness.studies.effects.friction import Ladder, friction, ladder
from harness.studies.effects.plan import Plan, design, plan
from harness.studies.effects.reading import Study, read, study

__all__ = ["Ladder", "Plan", "Study", "design", "friction", "ladder", "plan", "read", "study"]
