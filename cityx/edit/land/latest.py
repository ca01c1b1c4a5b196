"""The latest: what was added last of a kind, by which something new stands."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.city import City
from cityx.errors import ActionFailed

# Kinds of land and buildings of which a command may add one, whose ground others then stand round.
LAID = (
    "pond", "lake", "playground", "meadow", "lawn", "church", "school", "market", "parking_lot",
    "sports_field", "football_pitch", "tennis_court", "garden", "orchard", "allotments",
)  # fmt: skip
TABLES = ("areas", "buildings", "points")


def latest(city: City, kind: str) -> shapely.Geometry:
    """Return the ground of what was added last of a kind.

    Raises
    ------
    ActionFailed
        If none was added.
    """
    found: list[tuple[int, shapely.Geometry]] = []
    for name in TABLES:
        table = getattr(city.layout, name)
        sources = table["source"].to_numpy().astype(str)
        number = np.array([_number(source, kind) for source in sources], np.int64)
        found += [
            (int(number[row]), shape)
            for row, shape in enumerate(table.geometry.to_numpy()) if number[row] >= 0
        ]  # fmt: skip
    if not found:
        raise ActionFailed(f"No {kind.replace('_', ' ')} was added; name one that there is.")
    last = max(number for number, _ in found)
    return shapely.union_all([shapely.make_valid(shape) for at, shape in found if at == last])


def _number(source: str, kind: str) -> int:
    """Return which of those that were made something is, -1 for what was not: "made/market/2"."""
    parts = source.split("/")
    if len(parts) < 3 or parts[1] != kind or parts[0] not in ("made", "edit"):
        return -1
    return int(parts[2]) if parts[2].isdigit() else 0


def ring_round(shape: shapely.Geometry, reach: float) -> shapely.Geometry:
    """Return the ground round a shape, so many metres wide."""
    return shapely.difference(shapely.buffer(shape, reach), shape)
