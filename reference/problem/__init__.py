"""The problem: the can, its effects, its release, its states and the outcomes of a motion."""
