"""Facades: walls divided into bays, with openings, cornices and fixtures."""
