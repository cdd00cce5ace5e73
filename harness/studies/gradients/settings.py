"""What a small change of an engine's setting does to a bounce; the exact derivative is zero."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from harness.core.case import Case
from harness.core.report_model import Column
from harness.core.verdict import Status, Verdict
from harness.engines.ladder import rung_of
from harness.evaluation.evaluation import Record
from harness.studies.gradients.design import SETTING_STEPS, GradientPlan, with_setting

_STILL = 0.01
"""Change of a quantity over that of a setting, both relative, up to which it is of the motion."""

_PERCENT = SETTING_STEPS[0]
"""The step that is told: a percent."""

_DISAGREE = 1.0
"""Spread of the derivatives of three steps from which on they are none."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingChange:
    """How a quantity follows one number of an engine's settings.

    Parameters
    ----------
    base : Case
    setting, quantity : str
    value : float
        Of the setting in force.
    size : float
        Of the exact quantity.
    values : mapping of float to float or None
        Derivative by the logarithm of the setting, in the unit of the quantity, by relative step.
    """

    base: Case
    setting: str
    quantity: str
    value: float
    size: float
    values: Mapping[float, float | None]

    @property
    def by_percent(self) -> float | None:
        """The derivative by a step of one percent."""
        return self.values.get(_PERCENT)

    @property
    def per_percent(self) -> float | None:
        """Change of the quantity by one percent of the setting, in its unit, as it was run."""
        return None if self.by_percent is None else _PERCENT * self.by_percent

    @property
    def per_decade(self) -> float | None:
        """Change by a factor of ten if it went on like that, over the exact quantity."""
        if self.by_percent is None or not self.size:
            return None
        return math.log(10.0) * self.by_percent / self.size

    @property
    def spread(self) -> float | None:
        """Largest less smallest of the derivatives, over that by a percent."""
        known = [value for value in self.values.values() if value is not None]
        return (max(known) - min(known)) / abs(self.by_percent) if self.by_percent else None

    @property
    def verdict(self) -> Verdict:
        """Whether the quantity is that of the motion, or also of the setting.

        Where the steps disagree on the derivative it is not judged, unless all say next to nothing.
        """
        known = [abs(value) for value in self.values.values() if value is not None]
        if self.by_percent is None or not self.size > 0.0:
            return Verdict(Status.NOT_JUDGED, "not judged: the run has no such quantity")
        share = abs(self.by_percent) / self.size
        words = (
            f"one percent of it moves the quantity by {share:.2g} %; of the exact motion by none"
        )
        if max(known) / self.size <= _STILL:
            return Verdict(Status.AGREES, words)
        if self.spread is None or self.spread > _DISAGREE:
            return Verdict(
                Status.NOT_JUDGED, f"not judged: steps disagree on the derivative; {words}"
            )
        return Verdict(Status.AGREES if share <= _STILL else Status.DEVIATES, words)


def setting_changes(
    plan: GradientPlan, runs: Mapping[Case, Record], exact: Mapping[str, float | None]
) -> Iterator[SettingChange]:
    """Yield the changes of every quantity by every setting of the finest case of each engine.

    Parameters
    ----------
    plan : GradientPlan
    runs : mapping
        Records of the bases and of their changed cases.
    exact : mapping
        Exact quantities.
    """
    for base in plan.settled_bases:
        settings = runs[base]["settings"]
        for name, value in plan.settings_of(base, settings).items():
            ends = {
                step: [
                    runs[with_setting(base, settings, name, 1.0 + sign * step)]["numbers"]
                    for sign in (1.0, -1.0)
                ]
                for step in SETTING_STEPS
            }
            for quantity, size in exact.items():
                values = {
                    step: None
                    if (a := up.get(quantity)) is None or (b := down.get(quantity)) is None
                    else (a - b) / (2.0 * step)
                    for step, (up, down) in ends.items()
                }
                yield SettingChange(
                    base=base,
                    setting=name,
                    quantity=quantity,
                    value=value,
                    size=math.nan if size is None else abs(size),
                    values=values,
                )


SETTINGS_COLUMNS = (
    Column("engine", "Name of the engine.", "base.engine"),
    Column("timestep_s", "Timestep, or accuracy in its place.", lambda each: rung_of(each.base)),
    Column("setting", "Number of the engine's settings that is changed; of several, which."),
    Column("value", "In force.", shown=False),
    Column("quantity", "Quantity of the first bounce; the unit is its suffix."),
    Column("per_percent", "Change by one percent of the setting, in the unit of the quantity."),
    Column("per_decade", "Change by a factor of ten if it went on, over the exact quantity."),
    Column("spread", "Of the derivatives at three steps, over that by a percent.", shown=False),
    Column("verdict", "Whether the setting moves the quantity; the exact derivative is zero."),
)
