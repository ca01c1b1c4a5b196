"""Where street furniture stands."""
