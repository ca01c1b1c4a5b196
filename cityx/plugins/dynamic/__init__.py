"""Actions that let things move."""
