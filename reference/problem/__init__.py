"""What is solved: the can, its effects, the release, the states and how a motion can end."""
