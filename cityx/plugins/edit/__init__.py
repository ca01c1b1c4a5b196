"""Actions that change one thing."""
