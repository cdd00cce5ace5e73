"""Many random releases of a can on a plane with friction, each looked at from beginning to end."""
