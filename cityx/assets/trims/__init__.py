"""Trims: balconies, mouldings, dormers and roof furniture as prototypes."""
