"""The study of cost: what accuracy costs in time, for each engine, and which settings buy it."""
