"""Sweeps: many scenes that differ in a few parameters, a row of a table each."""
