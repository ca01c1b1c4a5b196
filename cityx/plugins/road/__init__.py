"""Actions that make roads and the ground."""
