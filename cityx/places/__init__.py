"""Places on Earth: what a coordinate says about how a city is built."""
