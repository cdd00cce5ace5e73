"""Timing cases alone, keeping what was measured, and resuming."""
