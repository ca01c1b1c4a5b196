"""Buildings: massing, roofs, facades, shops and the generators that combine them."""
