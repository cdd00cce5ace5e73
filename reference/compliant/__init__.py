"""A contact that gives way: the rim's lowest point has a depth, and the plane pushes by a law."""
