"""A city on disk: build, edit, undo, pull, views, results."""
