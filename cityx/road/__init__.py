"""Roads: network, surfaces, markings, heights, ground and parking."""
