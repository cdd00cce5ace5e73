"""Evaluations: a simulation with its measurements and its comparison with the truth."""

from dataclasses import dataclass
from typing import Any

from harness.core.bounce import Bounce
from harness.core.simulation import Simulation
from harness.engines.reference import Finding
from harness.engines.reference.assumption_checks import Divergence
from harness.metrics.error import Errors
from harness.metrics.motion import ContactQuality, Motion

Record = dict[str, Any]
"""Measurements of a case as numbers by name, such as its times, in types that JSON can hold."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Evaluation:
    """A simulation with its measurements and its comparison with the truth.

    Parameters
    ----------
    motion : Motion or None
        None if there is no trajectory.
    energy_drift : float or None
        Over m g R.
    truth : Motion or None
        The exact motion at the instants of `motion` up to where it is defined.
    errors : Errors or None
        None for a scene that the reference cannot carry, and for a chaotic one, in which the
        difference in the end is no error: `divergence` and `parts_at` say how long the motions can
        be compared.
    truth_pulls : bool
        True if the exact motion asks the plane to pull: no engine whose contact only pushes can
        follow it, and the errors say how the can leaves it.
    findings : tuple of Finding
        Assumptions of its model that the exact motion breaks, each with the model that carries the
        scene without that assumption.
    divergence : Divergence or None
        How fast disturbed releases separate; None for a scene that cannot be chaotic.
    parts_at : float or None
        When the orientation is first 0.1 rad from the truth's, s; None if it never is.
    """

    simulation: Simulation
    motion: Motion | None = None
    bounces: tuple[Bounce, ...] = ()
    energy_drift: float | None = None
    contact: ContactQuality | None = None
    truth: Motion | None = None
    true_bounces: tuple[Bounce, ...] = ()
    errors: Errors | None = None
    truth_pulls: bool = False
    findings: tuple[Finding, ...] = ()
    divergence: Divergence | None = None
    parts_at: float | None = None

    def _repr_html_(self) -> str:
        """Return what a notebook shows: a table of the run, and its first figure in the report."""
        from harness.api import to_html  # noqa: PLC0415 - a report is made of evaluations

        return to_html(self)
