"""Where people walk: walkable areas, crosswalks and the graph of walks."""
