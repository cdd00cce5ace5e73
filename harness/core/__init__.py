"""Cases, trajectories, simulations and report objects: what every other package speaks of."""
