"""What the documents are made with; not part of the package."""
