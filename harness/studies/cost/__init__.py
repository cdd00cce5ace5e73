"""The study of cost: time against accuracy for each engine, and the settings that buy it."""
