"""Cities without end: a map is split into tiles that are built alone, in any order, anywhere."""
