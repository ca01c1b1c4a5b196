"""The MCP server: a city that language models and other programs look at, change and render."""
