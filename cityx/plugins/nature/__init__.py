"""Actions that plant and furnish."""
