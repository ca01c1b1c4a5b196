"""The Python API: cities as objects with tables; `cityx` itself exports it."""
