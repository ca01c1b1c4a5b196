"""Turn restrictions: relations that forbid a turn or allow one alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

from cityx.city.layout import empty_table, make_table
from cityx.ids import stable_id
from cityx.sources.features.clipping import Box, FloatArray
from cityx.sources.features.tagged import Tags
from cityx.sources.osm.elements import OsmMap

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

CARS = ("motorcar", "motor_vehicle", "vehicle")


def restriction_table(osm: OsmMap, xy: FloatArray, box: Box) -> GeoDataFrame:
    """Read the restrictions at junctions of the site; those with a member missing are passed over.

    A restriction over a way instead of a node counts at the node where the way it comes from ends.
    """
    rows = []
    for key, members, tags in zip(osm.relation_id, osm.members, osm.relation_tags, strict=True):
        kind = _kind(tags)
        if not kind:
            continue
        roles: dict[str, list[tuple[str, int]]] = {}
        for member, reference, role in members:
            roles.setdefault(role, []).append((member, reference))
        begin = [ref for member, ref in roles.get("from", []) if member in ("w", "way")]
        end = [ref for member, ref in roles.get("to", []) if member in ("w", "way")]
        via = [ref for member, ref in roles.get("via", []) if member in ("n", "node")]
        place = _node_row(osm, via[0]) if via else -1
        if not begin or not end or place < 0:
            continue
        place_x, place_y = xy[place].tolist()
        if not (box[0] <= place_x <= box[2] and box[1] <= place_y <= box[3]):
            continue
        for origin in begin:
            for target in end:
                rows.append((key, origin, target, kind == "only", place_x, place_y))
    if not rows:
        return empty_table("restrictions")
    relations, origins, targets, only, x, y = zip(*rows, strict=True)
    ids = [stable_id("osm", "relation", *row[:3]) for row in rows]
    return make_table(
        "restrictions", shapely.points(np.array(x), np.array(y)), id=np.array(ids, np.uint64),
        source=[f"osm/relation/{key}" for key in relations],
        from_source=[f"osm/way/{key}" for key in origins],
        to_source=[f"osm/way/{key}" for key in targets], only=list(only),
    )  # fmt: skip


def _node_row(osm: OsmMap, node: int) -> int:
    row = int(np.searchsorted(osm.node_id, node))
    return row if row < len(osm.node_id) and osm.node_id[row] == node else -1


def _kind(tags: Tags) -> str:
    """Return "no", "only", or "" for a relation that does not bind cars all day."""
    if tags.get("type") != "restriction" or any(word in tags.get("except", "") for word in CARS):
        return ""
    value = tags.get("restriction") or tags.get("restriction:motorcar") or ""
    if "hour_on" in tags or "@" in tags.get("restriction:conditional", ""):
        return ""
    head = value.split("_")[0]
    return head if head in ("no", "only") and value != "no_entry" and value != "no_exit" else ""
