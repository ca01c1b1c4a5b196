"""Generators of houses and flats."""
