"""The ground: one arrangement of faces, its terrain, structures and what stands on it."""
