"""Rasters to shapes: grids on the ground, outlines of masks, centrelines, regions."""
