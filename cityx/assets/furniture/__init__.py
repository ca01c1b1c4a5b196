"""Street, park, yard and waterside furniture as prototypes."""
