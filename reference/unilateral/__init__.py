"""Contact that is lost and found again: flight, impact, landing flat, and rest."""
