"""Generators of public and sacred buildings."""
