"""The version of CityX."""

__version__ = "0.2.0"
