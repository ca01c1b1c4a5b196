"""Nature and furniture: trees, land and street furniture."""
