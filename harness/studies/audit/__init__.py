"""The audit: every equation and number of the paper, each with a computed verdict."""

from harness.studies.audit.finding import Finding, Ruling, Verdict
from harness.studies.audit.tables import audit_table, audit_words, counts, markdown

__all__ = ["Finding", "Ruling", "Verdict", "audit_table", "audit_words", "counts", "markdown"]
