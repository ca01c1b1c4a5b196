"""Actions that make or change the layout."""
