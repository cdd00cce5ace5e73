"""The attribution study: which of an engine's gaps causes which part of its discrepancy."""
