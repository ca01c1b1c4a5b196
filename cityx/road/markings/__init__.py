"""Road markings: lines, arrows, zebra crossings, symbols."""
