"""Integration of rolling: Picard-Chebyshev steps, time reversal, dense output, scipy's methods."""
