"""Actions that shape the terrain."""
