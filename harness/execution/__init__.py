"""Tasks, the result cache, isolated processes, Dask and signals; nothing here knows an engine."""
