"""Studies design cases and read their results; they run nothing."""
