"""What is measured of a motion, and against the truth."""
