"""Outputs of the quick suites, compared letter for letter across a change of structure."""
