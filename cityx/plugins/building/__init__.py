"""Actions that raise buildings."""
