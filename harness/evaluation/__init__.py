"""Run cases and measure them against the exact motion; time them alone; cache the results."""
