"""Styles: facade measures, palettes, materials and generator tables."""
