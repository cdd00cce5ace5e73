"""Motions that other programs wrote: read, understood, and held against the exact motion."""
