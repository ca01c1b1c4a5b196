"""Commands: sentences that change a city, parsed by a grammar."""
