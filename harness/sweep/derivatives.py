"""Columns of a sweep that are derivatives of its other columns: d_QUANTITY/d_KEY.

By the exact bounce they are of a whole one, from a maximum of phi to the next, and computed for
many releases at once. Where each scene is solved by itself they are of its first bounce, which a
release that falls opens.
"""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Literal

import numpy as np

from harness.core.case import Case
from harness.engines.reference.derivatives import (
    CAN,
    NAMES,
    RELEASE,
    derivatives_of,
    many_derivatives,
)
from harness.engines.reference.to_reference_problem import HONOURS, Releases
from harness.metrics.quantities import QUANTITIES as REGISTRY
from harness.metrics.quantities import Quantity
from harness.sweep.parameters import PARAMETERS, Floats

KEYS = (*(f"release.{name}" for name in RELEASE), *(f"can.{name}" for name in CAN), "gravity")
"""Keys of a scene by which the bounce of every can has derivatives."""

_OF_SOME = (
    "release.height",
    *(n for n in PARAMETERS if n.startswith("effects.") and n.split(".")[1] in HONOURS),
)


def _quantity(name: str, key: str) -> Quantity:
    """Return a derivative as a column of a sweep."""
    of, by = REGISTRY[name], PARAMETERS[key]
    return Quantity(
        key=f"d_{name}/d_{key}",
        label=f"derivative of the {of.label} by {key}",
        unit=f"{of.unit or '1'} per {by.unit or '1'}",
        meaning=f"Derivative of {name} of the exact bounce by {key}.",
        of_run=lambda _: None,  # of a scene, not of a run
    )


DERIVATIVES: Mapping[str, Quantity] = MappingProxyType(
    {
        f"d_{name}/d_{key}": _quantity(name, key)
        for name in NAMES.values()
        for key in (*KEYS, *_OF_SOME)
    }
)
"""Every derivative that a sweep may have, by name."""


_SEPARATRIX = (
    "Derivatives are of the exact motion; beside a separatrix, where the can all but stops, those "
    "of the period grow like one over the distance to it, and show a rounding of the release."
)

_AT_REST = (
    "Where the release is at rest, derivatives by its rate of phi are those towards larger values."
)


def caveats(names: Sequence[str]) -> tuple[str, ...]:
    """Return what is to be known of the derivatives among the columns of a sweep, in sentences."""
    keys = {parts_of(name)[1] for name in names if name in DERIVATIVES}
    if not keys:
        return ()
    return (_SEPARATRIX, _AT_REST) if "release.phi_dot" in keys else (_SEPARATRIX,)


def source_of(name: str) -> Literal["exact", "run"]:
    """Return whether a derivative is known of many releases at once, or of each scene by itself."""
    _, key = parts_of(name)
    return "exact" if key in KEYS else "run"


def parts_of(name: str) -> tuple[str, str]:
    """Return the quantity and the key of a derivative."""
    quantity, _, key = name.partition("/")
    return quantity.removeprefix("d_"), key.removeprefix("d_")


def of_releases(
    releases: Releases, gravity: Floats, radius: Floats, names: Sequence[str]
) -> dict[str, Floats]:
    """Return derivatives of many releases, by name, shape (n,) each."""
    asked = {parts_of(name)[0] for name in names}
    known = many_derivatives(releases, gravity, radius, asked)
    return {name: known[parts_of(name)] for name in names}


def of_cases(cases: Sequence[Case | str], names: Sequence[str]) -> dict[str, Floats]:
    """Return derivatives of the scenes of cases, each solved by itself; a sentence has none."""
    columns = {name: np.full(len(cases), np.nan) for name in names}
    for row, case in enumerate(cases):
        if not names or isinstance(case, str):
            continue
        slopes = derivatives_of(case.scene).slopes
        for name, column in columns.items():
            quantity, key = parts_of(name)
            known = slopes[quantity].get(key)
            column[row] = np.nan if known is None else known
    return columns
