"""Actions that set sun, sky and weather."""
