"""Actions that make or change the layout of a town without a map."""
