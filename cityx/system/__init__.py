"""The process and its files: caches, atomic writes, cores, memory."""
