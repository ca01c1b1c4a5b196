"""The asset library: records, geometry, embeddings, retrieval and placement.

A library is a folder with a table of records, packs of geometry and a vector index. It is grown
from our own generators on demand, or made of a user's files, and placed on the lots of a city.
"""
