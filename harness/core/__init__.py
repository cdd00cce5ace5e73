"""Cases, trajectories, simulations and report objects: the nouns that every package uses."""
