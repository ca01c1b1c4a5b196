"""Edits that add people and vehicles which stay at a place."""
