"""Releases of an engine held against each other: where contact changed, and by how much."""
