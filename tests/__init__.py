"""Tests, and the programs of a checkout: a package, so that no other one of this name is meant."""
