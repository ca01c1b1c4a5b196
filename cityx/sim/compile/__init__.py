"""How a world is compiled from a city, part by part."""
