"""Designs that several studies use."""
