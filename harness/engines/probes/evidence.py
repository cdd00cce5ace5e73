"""What a probe finds: numbers, each beside what the ideal can has, and curves."""

from dataclasses import dataclass

from harness.case import Case
from harness.trajectory import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One imposed effect in one number.

    Parameters
    ----------
    effect : str
        Such as "compliance" or "damping".
    quantity, unit : str
    value : float
        As measured in the engine.
    expected : float
        What the ideal can has, or the closed form of rigid-body mechanics.
    how : str
        One sentence: what was done.
    """

    effect: str
    quantity: str
    unit: str
    value: float
    expected: float
    how: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trace:
    """One imposed effect as a curve, y against x, each of shape (n,), labels with units."""

    effect: str
    x_label: str
    y_label: str
    x: Floats
    y: Floats


Evidence = Finding | Trace


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measurement:
    """All that the probes found in one engine with one choice of settings.

    Parameters
    ----------
    case : Case
        Its can, gravity, profile, timestep and options were probed; its release was not.
    engine_version : str
    timestep : float
        s.
    findings : tuple of Finding
    traces : tuple of Trace
    """

    case: Case
    engine_version: str
    timestep: float
    findings: tuple[Finding, ...]
    traces: tuple[Trace, ...]
