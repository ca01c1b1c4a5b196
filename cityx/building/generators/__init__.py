"""Building generators, one module per kind."""
