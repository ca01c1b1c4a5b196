"""People as prototypes: bodies, clothes, hair, poses and gaits."""
