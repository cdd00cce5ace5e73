"""The audit: every equation and number of the paper, each with a computed verdict."""

from harness.paper.audit.finding import AuditRow, ClaimStatus, Ruling
from harness.paper.audit.tables import audit_table, audit_words, counts, markdown

__all__ = ["AuditRow", "ClaimStatus", "Ruling", "audit_table", "audit_words", "counts", "markdown"]
