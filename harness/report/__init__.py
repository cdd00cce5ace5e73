"""What a report looks like: artefacts in, one folder out."""
