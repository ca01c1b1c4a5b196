"""File formats at the edge: views made from a City."""
