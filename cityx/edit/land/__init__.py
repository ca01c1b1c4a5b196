"""Edits of streets and open land: widths, trees, furniture, ponds, fences."""
