"""Measures of a motion, and of its errors against the exact one."""
