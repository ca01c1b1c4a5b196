"""Actions that make the terrain."""
