"""Mutation testing of the modules that judge: what the tests would not notice if it changed."""
