"""The validity report: what a city holds and what is wrong with it."""
