"""Edits of buildings: heights, storeys, roofs, materials, styles."""
