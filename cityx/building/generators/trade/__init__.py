"""Generators of buildings for trade, industry and farming."""
