"""What an engine says a small change does, against the exact derivative."""
