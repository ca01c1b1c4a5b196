"""References: what the words of a sentence are in a city that exists."""
