"""Ground truth without end: shots of a city, their channels, and the files that hold them."""
