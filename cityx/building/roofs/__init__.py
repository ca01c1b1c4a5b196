"""Roofs: shapes, meshes, edges, dormers and rooftop furniture."""
