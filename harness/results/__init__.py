"""Results as files: what a suite measured of engines, in one format that is published."""
