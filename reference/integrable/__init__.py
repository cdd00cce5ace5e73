"""The exact bounce: first integrals, effective potential, turning points and quadratures."""
