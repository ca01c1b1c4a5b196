"""CityX: words, maps and height fields become explicit, editable 3D cities."""

__version__ = "0.2.0"
