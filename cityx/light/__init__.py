"""Sun, sky, weather and lights."""
