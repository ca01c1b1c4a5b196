"""The closed list of slots: what a key means, and which may have but one value."""

from __future__ import annotations

from cityx.system.tables import load, table

# Key -> meaning. Keys with ".min" and ".max" bound the key without it.
KEYS = table("language/slots", str, "keys")
# Families: what is measured of any thing with a name, "river.width", "tree.count", "beach.side".
MEASURED = ("count", "width", "length", "height", "area", "side", "share", "size.x", "size.y")
SINGLE = load("language/slots", frozenset[str], "single")


def is_key(key: str) -> bool:
    """Tell whether a key is one of the closed list."""
    base = key.removesuffix(".min").removesuffix(".max")
    family = any(base.endswith(f".{name}") and len(base) > len(name) + 1 for name in MEASURED)
    return base in KEYS or family
