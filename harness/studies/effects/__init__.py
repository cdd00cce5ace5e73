"""The effects study: effects that a scene needs, their cost, and those that an engine imposes."""
