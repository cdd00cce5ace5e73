"""Run every check: claims in, rows of the audit out."""

import time
from collections.abc import Callable, Iterator, Sequence

from harness.paper.audit import checks  # noqa: F401 - registers them
from harness.paper.audit.claims import CLAIMS, AuditRow, Claim
from harness.paper.audit.evidence import check_of, name_of


def audit(
    claims: Sequence[Claim] = CLAIMS, on_start: Callable[[Claim], None] | None = None
) -> Iterator[AuditRow]:
    """Check claims one by one.

    Parameters
    ----------
    claims : sequence of Claim
    on_start : callable, optional
        Called with each claim before it is checked, to show progress.

    Yields
    ------
    AuditRow
    """
    for claim in claims:
        if on_start is not None:
            on_start(claim)
        start = time.perf_counter()
        ruling = check_of(claim.label)().ruling()
        yield AuditRow(
            claim=claim,
            ruling=ruling,
            check=name_of(claim.label),
            seconds=time.perf_counter() - start,
        )
