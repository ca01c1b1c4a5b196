"""The library: materials, textures and prototypes, all made by code."""
