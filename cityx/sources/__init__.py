"""Inputs: every one becomes the same layout."""
