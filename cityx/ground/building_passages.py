"""Passages: where ways lead through houses on the ground, and how high they are."""

from __future__ import annotations

import json
from dataclasses import dataclass
from math import nan
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_HEIGHT
from cityx.city.layout import is_mesh
from cityx.sources.features.measures import measure
from cityx.system.remembered import Remembered

if TYPE_CHECKING:
    from cityx.city.layout import Layout
    from cityx.city.terrain import Terrain

FROM_GROUND = 0.5  # metres; parts that begin lower stand on the ground
# Metres of headroom where nothing is said: of walkers, of carriageways (the usual maxheight of
# streets), of trams and of trains with their wires.
ON_FOOT, STREET, TRAM, TRAIN = 3.0, 4.5, 4.8, 5.6
KINDS_ON_FOOT = ("footway", "path", "steps", "cycleway", "pedestrian", "corridor", "bridleway")
TRAMS, TRAINS = ("tram", "light_rail"), ("rail", "narrow_gauge", "subway", "monorail")
LEAST_HEADROOM = 2.0  # metres; a door
LEAST_WIDTH = {"tram": 3.4, "light_rail": 3.4, "rail": 4.6, "narrow_gauge": 3.6, "subway": 3.6}
LEAST_WALK = 1.2  # metres
LINTEL = 0.3  # metres of house that are left between a passage and the eave
AT_WALL = 1.0  # metres from a wall within which a way that ends leads out of the house
OPEN = 0.1  # square metres; less of a house under a way is drawing noise
EVERY = 1.0  # metres between the places along a way at which the terrain is looked up
_STATED = ("maxheight:physical", "maxheight", "height", "clearance")


@dataclass(frozen=True)
class Passages:
    """Passages through the parts of a layout, p pairs of a part and a way.

    Attributes
    ----------
    part, road
        (p,) rows of the tables.
    room
        (p,) polygons, the free way with what lies before its mouths, metres.
    headroom
        (p,) metres above the way.
    """

    part: NDArray[np.int64]
    road: NDArray[np.int64]
    room: NDArray[Any]
    headroom: NDArray[np.float64]

    def by_part(self, count: int) -> NDArray[Any]:
        """Return what all ways take of the plan of each of so many parts, empty for nothing."""
        taken = np.full(count, shapely.Polygon(), object)
        for part in np.unique(self.part).tolist():
            taken[part] = shapely.union_all(self.room[self.part == part])
        return taken


_LAST: Remembered[Passages] = Remembered()


def passages(layout: Layout) -> Passages:
    """Find the ways that lead through the parts of buildings that stand on the ground."""
    return _LAST.get(lambda: _found(layout), [layout])


def _found(layout: Layout) -> Passages:
    roads, parts = layout.roads, layout.parts
    rows = np.flatnonzero(roads["passage"].to_numpy(bool) & ~roads["bridge"].to_numpy(bool))
    standing = (parts["base"].to_numpy(float) < FROM_GROUND) & parts["walls"].to_numpy(bool)
    standing &= ~is_mesh(layout)
    shapes = np.where(standing, parts.geometry.to_numpy(), shapely.Polygon())
    none = np.zeros(0, np.int64)
    if not len(rows) or not standing.any():
        return Passages(none, none, np.zeros(0, object), np.zeros(0))
    lines = roads.geometry.to_numpy()[rows]
    width = _widths(layout)[rows]
    owner = parts["building"].to_numpy(np.uint64)
    tree = shapely.STRtree(shapes)
    way, part = tree.query(lines, predicate="intersects")
    through = {(w, int(owner[p])) for w, p in zip(way.tolist(), part.tolist(), strict=True)}
    # A way that leads through one part of a house takes its room of the parts beside it.
    way, part = tree.query(lines, predicate="dwithin", distance=width / 2)
    same = [(w, int(owner[p])) in through for w, p in zip(way.tolist(), part.tolist(), strict=True)]
    way, part = way[same], part[same]
    order = np.lexsort((roads["id"].to_numpy(np.uint64)[rows[way]], part))
    way, part = way[order], part[order]
    room = np.array(
        [_room(lines[w], shapes[p], width[w]) for w, p in zip(way, part, strict=True)], object
    )
    inside = shapely.area(shapely.intersection(room, shapes[part])) > OPEN
    way, part, room = way[inside], part[inside], room[inside]
    return Passages(part, rows[way], room, _headrooms(layout, rows)[way])


def open_ways(layout: Layout) -> NDArray[Any]:
    """Return what passages take of the plan of each part, (n,) geometries, empty for nothing."""
    return passages(layout).by_part(len(layout.parts))


def ceilings(layout: Layout, terrain: Terrain, found: Passages) -> NDArray[np.float64]:
    """Return the level that each passage is free up to, (p,) metres: the highest along its way."""
    lines = shapely.intersection(layout.roads.geometry.to_numpy()[found.road], found.room)
    points, row = shapely.get_coordinates(shapely.segmentize(lines, EVERY), return_index=True)
    floor = np.full(len(found.part), -np.inf)
    np.maximum.at(floor, row, terrain.height_at(points))
    return np.asarray(floor + KERB_HEIGHT + found.headroom)


def _widths(layout: Layout) -> NDArray[np.float64]:
    """Return the metres that each way takes, walks included, (r,)."""
    roads = layout.roads
    width = np.nan_to_num(roads["width"].to_numpy(float), nan=0.0)
    width = width + 2 * np.maximum(
        roads["sidewalk_left"].to_numpy(float), roads["sidewalk_right"].to_numpy(float)
    )
    least = [LEAST_WIDTH.get(kind, LEAST_WALK) for kind in roads["kind"].to_numpy(str).tolist()]
    return np.maximum(width, np.array(least, float))


def _headrooms(layout: Layout, rows: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the headroom that tags state, else what is usual, (k,) metres."""
    kinds = layout.roads["kind"].to_numpy(str)[rows]
    usual = np.select(
        [np.isin(kinds, KINDS_ON_FOOT), np.isin(kinds, TRAMS), np.isin(kinds, TRAINS)],
        [ON_FOOT, TRAM, TRAIN], default=STREET,
    )  # fmt: skip
    texts = layout.roads["tags"].to_numpy(str)[rows].tolist()
    said = np.array([_stated(text) for text in texts], float)
    return np.where(np.isnan(said), usual, np.maximum(said, LEAST_HEADROOM))


def _stated(tags: str) -> float:
    own = json.loads(tags) if "height" in tags or "clearance" in tags else {}
    found = (measure(own.get(key), 0.1, 100.0) for key in _STATED)
    return next((value for value in found if value is not None), nan)


def _room(line: Any, plan: Any, width: float) -> Any:
    """Return the room that a way takes, led on through the wall in which it ends."""
    points = shapely.get_coordinates(line)
    reach = width + AT_WALL
    ends = []
    for end, inner in ((points[0], points[1]), (points[-1], points[-2])):
        out = (end - inner) / max(float(np.hypot(*(end - inner))), 1e-9)
        leads = shapely.distance(shapely.boundary(plan), shapely.Point(end)) < AT_WALL
        ends.append([end + reach * out] if leads else [])
    longer = shapely.LineString([*ends[0], *points, *ends[1]])
    return shapely.buffer(longer, width / 2, cap_style="flat", join_style="mitre", mitre_limit=2.0)
