"""Vehicles as prototypes, and everything that moves as rows of a scene."""
