"""The compiled model against the scene's, before any trajectory."""
