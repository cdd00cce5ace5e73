"""Run every check: claims in, findings out."""

import time
from collections.abc import Callable, Iterator

from harness.paper.audit import checks  # noqa: F401 - registers the claims
from harness.paper.audit.causes import causes_of
from harness.paper.audit.finding import WRONG, AuditRow
from harness.paper.audit.labels import LABELS, place
from harness.paper.audit.registry import Claim, registered


def claims() -> tuple[Claim, ...]:
    """Return every claim that has a check: by section, equations in order, then the rest."""
    order = {label: place for place, label in enumerate(LABELS)}
    return tuple(
        sorted(registered(), key=lambda c: (_place(c.section), order.get(c.label, len(order))))
    )


def audit(
    chosen: tuple[Claim, ...] | None = None, on_start: Callable[[Claim], None] | None = None
) -> Iterator[AuditRow]:
    """Check claims one by one.

    Parameters
    ----------
    chosen : tuple of Claim, optional
        All if left out.
    on_start : callable, optional
        Called with each claim before it is checked, to show progress.

    Yields
    ------
    Finding
    """
    for claim in claims() if chosen is None else chosen:
        if on_start is not None:
            on_start(claim)
        start = time.perf_counter()
        ruling = claim.check().ruling()
        yield AuditRow(
            label=claim.label,
            section=claim.section,
            says=claim.says,
            ruling=ruling,
            check=claim.name,
            seconds=time.perf_counter() - start,
            place=place(claim.label),
            causes=causes_of(claim.label) if ruling.verdict in WRONG else (),
        )


def _place(section: str) -> tuple[int, int, float]:
    """Return where a section stands: the abstract first, appendices last."""
    if not section[0].isdigit():
        return (0, 0, 0.0) if section == "abstract" else (2, ord(section[0]), 0.0)
    number, _, part = section.partition(".")
    return (1, int(number), float(part or 0))
