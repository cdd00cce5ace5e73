"""What one study hands to a report: its artefacts, its cases, and what made them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from harness.core.provenance import Provenance
from harness.core.report_model import Artefact, Table

FIDELITY = "fidelity"
"""The table that only the comparison of engines has: every quantity and its verdict."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Section:
    """The whole of a report of one study, or a part of a report of several.

    Parameters
    ----------
    title : str
    artefacts : tuple of Artefact
        In reading order.
    cases : tuple of mapping
        One for each case, with what JSON can hold; the keys `digest`, `label` and `command` are
        shown.
    provenance : Provenance
    fine : bool
        Whether the curves are thinned already, as those that were read from a report are.
    """

    title: str
    artefacts: tuple[Artefact, ...]
    cases: tuple[Mapping[str, Any], ...]
    provenance: Provenance
    fine: bool = False

    @property
    def compares(self) -> bool:
        """Whether it is the comparison of engines, which a page tells scene by scene."""
        return any(isinstance(a, Table) and a.name == FIDELITY for a in self.artefacts)


def ordered(chapters: Sequence[Section]) -> tuple[Section, ...]:
    """Return chapters as they are read: the comparison first, the others as they come."""
    return tuple(sorted(chapters, key=lambda chapter: not chapter.compares))
