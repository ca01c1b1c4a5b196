"""Features: what any source found, as tagged shapes, resolved into the tables of a layout."""
