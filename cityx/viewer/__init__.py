"""The city in a browser: chunks, server, page, static sites."""
