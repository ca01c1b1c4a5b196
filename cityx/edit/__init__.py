"""Actions that change a city that exists."""
