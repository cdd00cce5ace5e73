"""The project's claims about speed, measured: each a ratio of two timings in one run."""
