"""Windows and doors as prototypes."""
