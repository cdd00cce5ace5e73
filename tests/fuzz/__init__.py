"""Fuzzing: scene files that nobody wrote, and names that mean harm."""
