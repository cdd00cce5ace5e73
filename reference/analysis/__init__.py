"""Analysis of a solution: bounces, validity, conditioning, divergence, sampling."""
