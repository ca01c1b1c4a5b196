"""Parks, gardens, shores, barriers and frontages."""
