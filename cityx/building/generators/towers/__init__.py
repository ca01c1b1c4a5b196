"""Generators of towers and office buildings."""
