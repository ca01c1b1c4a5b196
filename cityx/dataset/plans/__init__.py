"""Plans: where the pictures of a dataset are taken, one module per kind."""
