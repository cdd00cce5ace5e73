"""Studies design cases and read what came of them; they run nothing."""
