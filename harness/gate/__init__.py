"""The gate: results held against accepted ones, within a tolerance that was measured."""
