"""The effects study: which effects a scene needs, what each costs, what an engine adds unasked."""

from harness.studies.effects.friction import Ladder, friction, ladder
from harness.studies.effects.plan import EffectsPlan, effects_cases, plan_effects
from harness.studies.effects.report import EffectsResults, effects_report, effects_results

__all__ = [
    "EffectsPlan",
    "EffectsResults",
    "Ladder",
    "effects_cases",
    "effects_report",
    "effects_results",
    "friction",
    "ladder",
    "plan_effects",
]
