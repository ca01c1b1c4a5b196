"""The road network: graph, cross-sections, lanes, signals, streets on curves."""
