"""What is read off a solution: bounces, validity, conditioning, divergence, sampling."""
