"""Massing: the volume of a building grows by grammar rules."""
