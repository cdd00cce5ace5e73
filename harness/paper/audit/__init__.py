"""The audit: every equation and number of the paper, each with a computed verdict."""

from harness.paper.audit.claims import CLAIMS, AuditRow, Claim, ClaimStatus
from harness.paper.audit.tables import audit_table, audit_words, counts, markdown

__all__ = [
    "CLAIMS",
    "AuditRow",
    "Claim",
    "ClaimStatus",
    "audit_table",
    "audit_words",
    "counts",
    "markdown",
]
