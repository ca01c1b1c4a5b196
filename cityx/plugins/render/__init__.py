"""Actions that make pictures."""
