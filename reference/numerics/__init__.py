"""Root finding and batches."""
