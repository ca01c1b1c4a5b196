"""Motion: traffic, pedestrians, crowds and characters on paths."""
