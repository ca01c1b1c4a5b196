"""Blocks, parcels, lots and street patterns as arrays."""
