"""Equations of motion, contact laws, reaction forces, energy and steady motions."""
