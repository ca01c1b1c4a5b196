"""Road surfaces: carriageways, junction corners, kerbs, refuges, roundabouts."""
