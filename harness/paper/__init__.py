"""What is about the paper itself: the audit of its claims and the gallery of its figures."""
