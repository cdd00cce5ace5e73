"""Stick, slip and lift-off: the hybrid integrator, its events and transitions."""
