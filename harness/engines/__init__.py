"""Everything that moves a can, each behind one role."""
