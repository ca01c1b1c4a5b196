"""Pure functions on arrays and shapely geometries: arrays in, new arrays out."""
