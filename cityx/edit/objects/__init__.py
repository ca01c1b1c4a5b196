"""Edits of objects: move, copy, turn, scale, paint, replace, remove."""
