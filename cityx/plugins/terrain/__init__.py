"""Actions of the stage terrain."""
