"""The stability study: where an engine stops being usable, and how it fails."""
