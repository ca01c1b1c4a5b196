"""The lexicon: words, numbers, units and the phrase book."""
