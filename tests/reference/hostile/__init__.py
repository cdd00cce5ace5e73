"""Releases constructed to mislead a search for turning points."""
