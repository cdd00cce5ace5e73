"""Description of an engine: what reports, estimates, benchmarks and probes have to know of it.

An engine declares one as its attribute `description`, and what it leaves out has a default. An
adapter of this project holds it in its package as `DESCRIPTION`, which is read without the engine's
own package: a report of another machine has its colours here.
"""

import math
from dataclasses import dataclass
from enum import Enum


class Precision(Enum):
    """Floating point numbers in which an engine computes."""

    DOUBLE = "double"
    SINGLE = "single"

    @property
    def epsilon(self) -> float:
        """Distance from 1 to the next number."""
        return 2.0**-52 if self is Precision.DOUBLE else 2.0**-23


class Method(Enum):
    """How an engine advances, and so with what it may be compared."""

    FIXED_TIMESTEP = "fixed timestep"
    ERROR_CONTROL = "own error control"
    CONSTRAINT = "constraint"
    """Rolling is imposed: the plane may pull, and nothing slides or lifts off."""

    @property
    def refusal(self) -> str:
        """Why what is asked of a contact cannot be asked of an engine; empty if it can."""
        return "does not apply: constraint" if self is Method.CONSTRAINT else ""


APART = (
    "Rolling is imposed as a constraint: the plane may pull, and nothing slides or lifts off. "
    "Such an engine solves another problem than contact, and is ranked with none that has contacts."
)
"""Why engines of method `CONSTRAINT` have a part of their own in every table."""

FLIGHT = "release.height"
"""What a scene asks for that releases its can above the plane, as effects are named."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Description:
    """What the rest of the program has to know of an engine.

    Parameters
    ----------
    label : str
        Name for people; empty for the engine's own name.
    light, dark : str
        Colour of its curves on a light and on a dark page, #rrggbb; empty for a colour that no
        other curve of the report has.
    dashes : tuple of int
        Strokes and gaps of its first curve, CSS pixels; empty for an unbroken line.
    precision : Precision
        Decides how closely the compiled can has to be the scene's.
    method : Method
    accuracy_setting : str
        Of an engine with error control, the setting that bounds the error of its steps: it stands
        where another engine has its timestep.
    accuracies : tuple of float
        Values of that setting that studies run, from coarse to fine.
    tells_forces : bool
        Whether the contact force that it hands over is the one that moved the can.
    by_default : bool
        Whether it takes part, once installed, where no engine is named.
    import_s : float
        Longest time that its import may take, s: more where kernels are compiled.
    compiles : bool
        Whether the engine compiles its own program on first use, which may take minutes.
    step_s : float
        Processor time of a step on a usual machine, s, for estimates.
    overhead, overhead_of_short : float
        Largest ratios that are claimed of a run's time to that of a loop that only steps: at a
        timestep of 1e-6 s, where most steps are not read, and at 1e-4 s, where most are.
    overhead_of_reading : float
        Likewise at 1e-4 s, to the leanest loop that keeps each state and its contact.
    adaptive_gain : float
        Least ratio that is claimed of the time of a fixed timestep to that of profile `adaptive`,
        at the same error.
    """

    label: str = ""
    light: str = ""
    dark: str = ""
    dashes: tuple[int, ...] = ()
    precision: Precision = Precision.DOUBLE
    method: Method = Method.FIXED_TIMESTEP
    accuracy_setting: str = ""
    accuracies: tuple[float, ...] = ()
    tells_forces: bool = True
    by_default: bool = True
    import_s: float = 60.0
    compiles: bool = False
    step_s: float = 1e-5
    overhead: float = math.inf
    overhead_of_short: float = math.inf
    overhead_of_reading: float = math.inf
    adaptive_gain: float = 1.0
