"""Height files as a source: formats, mosaics, surface models."""
