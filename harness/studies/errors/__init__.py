"""The errors study: model form, discretisation and solver of an engine, separated."""
