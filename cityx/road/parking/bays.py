"""Parking bays of car parks and yards: where they lie, and the lines between them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.furniture.tree_pits import ISLAND
from cityx.city import City
from cityx.city.ground import LABEL
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.clearance import near_any
from cityx.geometry.polylines import pack
from cityx.ground.standing import stand_on
from cityx.ids import hash_ids, stable_id
from cityx.places.profiles import profile_of
from cityx.road.ground.yards import BAY, STALL, Patches, yard_patches
from cityx.road.heights.tiers import level_network
from cityx.road.markings.marks import painted_strips
from cityx.system.remembered import Remembered

LAYER = "bay_lines"
PURPOSE = "road/parked_cars-v1"
AISLE = 6.0  # metres between two rows of bays
AISLE_AT = 2.0  # half bays from the middle of a bay to the aisle behind it
TRIAL_STEP = 1.5  # metres from one distance between the edge of a car park and its rows to the next
CAR_RADIUS = 2.7  # metres, half the diagonal of a car
SMALLEST_LOT = 60.0  # square metres
MOST_STALLS = 4_000  # per car park; beyond, a mapping error rather than a car park
# Bays of a car park with islands, of a row that has them at its ends, and from one to the next.
LARGE_LOT, LEAST_RUN, ISLAND_EVERY = 36, 8, 9
LINE, OVER = 0.10, 0.012  # metres, breadth of a line and its height above the asphalt
WITHIN = 0.06  # metres by which a line keeps off the ends of its bay


@dataclass(frozen=True)
class Bays:
    """Parking bays, b of them.

    Attributes
    ----------
    xy
        (b, 2) float, middles.
    id
        (b,) uint64.
    yaw
        (b,) float, radians; where the front of a car looks that was driven in forwards.
    """

    xy: FloatArray
    id: NDArray[np.uint64]
    yaw: FloatArray

    def take(self, rows: Any) -> Bays:
        """Return some of the bays, by mask or by index."""
        return Bays(self.xy[rows], self.id[rows], self.yaw[rows])


def join_bays(groups: Sequence[Bays]) -> Bays:
    """Put bays one after the other."""
    names = ("xy", "id", "yaw")
    return Bays(*(np.concatenate([getattr(group, name) for group in groups]) for name in names))


def _rows(depth: float) -> tuple[FloatArray, FloatArray]:
    """Middles of the rows of bays across a car park, and which way their cars face."""
    if depth < STALL:
        return np.zeros(0), np.zeros(0)
    if depth < STALL + AISLE:
        return np.array([depth / 2]), np.array([1.0])
    module = 2 * STALL + AISLE
    middles, facing = [], []
    start = 0.0
    while start + STALL + AISLE <= depth:  # cars come to the row from the aisle behind it
        middles.append(start + STALL / 2)
        facing.append(-1.0)
        if start + module <= depth:
            middles.append(start + module - STALL / 2)
            facing.append(1.0)
        start += module
    return np.array(middles), np.array(facing)


def _none() -> Bays:
    return Bays(np.zeros((0, 2)), np.zeros(0, np.uint64), np.zeros(0))


def lot_bays(city: City) -> Bays:
    """Lay double rows of bays along the long side of every car park of the map.

    Of large car parks some places are islands, see `lot_islands`.
    """
    bays = _laid(city)[0]
    return bays.take(~np.isin(bays.id, lot_islands(city).id))


def lot_islands(city: City) -> Bays:
    """Return the places of bays at which islands with a tree lie.

    They are the ends of rows of large car parks, and some places between, where all of the island
    lies on the surface of its car park and none on a way.
    """
    bays, island = _laid(city)
    islands = bays.take(island)
    ahead = np.column_stack([np.sin(islands.yaw), -np.cos(islands.yaw)])
    right = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    wide, long = np.array(ISLAND) / 2
    corners = [islands.xy + i * wide * right + j * long * ahead
               for i in (-1, 1) for j in (-1, 0, 1)]  # fmt: skip
    under = stand_on(city.scene.meshes.get("ground"), np.concatenate(corners)).label
    return islands.take((under.reshape(len(corners), -1) == LABEL["parking"]).all(axis=0))


def _island_places(lot: IntArray, row: IntArray, number: IntArray) -> BoolArray:
    """(n,) which of some bays, by lot, row and number along it, are islands."""
    large = np.isin(lot, np.flatnonzero(np.bincount(lot) >= LARGE_LOT)) if len(lot) else lot > 0
    order = np.lexsort((number, row, lot))
    key = np.stack([lot, row, number - np.arange(len(lot))[np.argsort(order)]], axis=1)[order]
    starts = np.r_[True, (key[1:] != key[:-1]).any(axis=1)][: len(lot)]
    run = np.cumsum(starts) - 1
    first = np.flatnonzero(starts)
    size = np.diff(np.r_[first, len(lot)])[run]
    place = np.arange(len(lot)) - first[run]
    ends = (place == 0) | (place == size - 1)
    between = (place % ISLAND_EVERY == 0) & (place + ISLAND_EVERY // 2 < size)
    found = np.zeros(len(lot), bool)
    found[order] = (ends | between) & (size >= LEAST_RUN)
    return np.asarray(found & large)


_LAST: Remembered[tuple[Bays, BoolArray]] = Remembered()


def _laid(city: City) -> tuple[Bays, BoolArray]:
    """Return the places of the bays of car parks, and which of them are islands."""
    tables = [city.layout.areas, city.layout.buildings, city.layout.roads]
    return _LAST.get(lambda: _laid_anew(city), tables)


def _laid_anew(city: City) -> tuple[Bays, BoolArray]:
    """Lay the bays of car parks.

    Of the ways to lay rows in a car park, along either side of the box around it and at several
    distances from its edge, the one with most bays wins.
    """
    areas = city.layout.areas
    rows = np.flatnonzero(areas["kind"].to_numpy().astype(str) == "parking")
    shapes = areas.geometry.to_numpy()[rows]
    big = shapely.area(shapes) > SMALLEST_LOT
    rows, shapes = rows[big], shapes[big]
    found: list[Bays] = []
    where: list[IntArray] = []  # lot, way of laying, row across it, number along that, and aisle
    for lot, frame in enumerate(shapely.oriented_envelope(shapes)):
        key = areas["id"].to_numpy()[rows[lot]]
        for trial, (xy, yaw, grid, deep) in enumerate(_trials(shapely.get_coordinates(frame))):
            if len(xy) and len(xy) <= MOST_STALLS:
                ids = hash_ids(0, f"{PURPOSE}/lot", key, np.arange(len(xy)))
                found.append(Bays(xy, ids, yaw))
                of = np.broadcast_to([[lot], [trial], [int(deep)]], (3, len(xy)))
                where.append(np.concatenate([of[:2], grid, of[2:]]))
    if not found:
        return _none(), np.zeros(0, bool)
    bays, places = join_bays(found), np.concatenate(where, axis=1)
    free = _on_lots(city, bays, shapes, places[4] > 0)
    bays, places = bays.take(free), places[:, free]
    count = np.zeros((len(shapes), int(places[1].max(initial=0)) + 1), np.int64)
    np.add.at(count, (places[0], places[1]), 1)
    best = count.argmax(axis=1)[places[0]] == places[1]
    return bays.take(best), _island_places(*places[[0, 2, 3]][:, best])


def _trials(corner: FloatArray) -> Iterator[tuple[FloatArray, FloatArray, IntArray, bool]]:
    """Yield ways to lay b bays in a box: middles, yaws, rows and numbers; whether it has aisles."""
    if len(corner) < 4:
        return
    a, b = corner[1] - corner[0], corner[2] - corner[1]
    turned = np.hypot(*a) < np.hypot(*b)
    for side, end, origin in ((b, -a, corner[1]), (a, b, corner[0]))[:: 1 if turned else -1]:
        length, depth = float(np.hypot(*side)), float(np.hypot(*end))
        u, v = side / max(length, 1e-6), end / max(depth, 1e-6)
        along = np.arange(0.5 * BAY + 0.5, length - 0.5 * BAY, BAY)
        spare = depth - STALL - AISLE
        for start in np.arange(0.0, max(min(STALL + AISLE, spare), 0.0) + 1e-6, TRIAL_STEP):
            across, facing = _rows(depth - start)
            s, t = np.meshgrid(along, start + across, indexing="ij")
            xy = origin + s.reshape(-1, 1) * u + t.reshape(-1, 1) * v
            way = np.tile(facing, len(along))[:, None] * v
            grid = np.indices(s.shape).reshape(2, -1)[::-1]
            yield xy, np.arctan2(way[:, 0], -way[:, 1]), grid, spare >= 0


def _on_lots(city: City, bays: Bays, shapes: NDArray[Any], deep: BoolArray) -> BoolArray:
    """(b,) bays that lie within car parks with an aisle behind, clear of houses and of ways.

    The street is the aisle of car parks too narrow for one.
    """
    inside = np.ones(len(bays.id), bool)
    ahead = 0.5 * STALL * np.column_stack([np.sin(bays.yaw), -np.cos(bays.yaw)])
    for share in (-AISLE_AT, -0.95, 0.95):
        hit = ~deep if share == -AISLE_AT else np.zeros(len(inside), bool)
        ends = shapely.STRtree(shapely.points(bays.xy + share * ahead))
        hit[ends.query(shapes, predicate="contains")[1]] = True
        inside &= hit
    inside[inside] = ~near_any(bays.xy[inside], city.layout.buildings.geometry.to_numpy(),
                               CAR_RADIUS)  # fmt: skip
    roads = city.layout.roads
    open_ = ~roads["tunnel"].to_numpy() & ~roads["bridge"].to_numpy()
    half = np.nan_to_num(roads["width"].to_numpy()[open_] / 2, nan=1.5)
    inside[inside] = ~near_any(bays.xy[inside], roads.geometry.to_numpy()[open_],
                               np.fmin(half, 3.0) + 1.3)  # fmt: skip
    return inside


def yard_lots(city: City) -> Patches:
    """Return the car parks of yards of a city with a network."""
    assert city.network is not None
    level = level_network(city.network, city.heights)
    return yard_patches(city.layout, level, profile_of(city.frame).land).labelled("parking")


def yard_bays(city: City) -> Bays:
    """Lay rows of bays on the car parks of yards."""
    ground = city.ground
    if city.network is None or ground is None:
        return _none()
    patches = yard_lots(city)
    found = [_none()]
    count = np.rint(patches.size[:, 0] / BAY).astype(np.int64)
    for depth in np.unique(patches.size[:, 1]).tolist():
        held = np.flatnonzero(patches.size[:, 1] == depth)
        across = np.array([-patches.along[held, 1], patches.along[held, 0]]).T
        for side, (middle, facing) in enumerate(zip(*_rows(depth), strict=True)):
            row = np.repeat(np.arange(len(held)), count[held])
            number = np.arange(len(row)) - np.searchsorted(row, row)
            shift = (number - (count[held][row] - 1) / 2) * BAY
            xy = patches.middle[held][row] + patches.along[held][row] * shift[:, None]
            xy = xy + across[row] * (middle - depth / 2)
            ids = hash_ids(0, f"{PURPOSE}/yard/{side}", patches.id[held][row], number)
            way = facing * across[row]
            found.append(Bays(xy, ids, np.arctan2(way[:, 0], -way[:, 1])))
    bays = join_bays(found)
    ahead = 0.48 * STALL * np.column_stack([np.sin(bays.yaw), -np.cos(bays.yaw)])
    whole = [ground.on(bays.xy + share * ahead, "parking") for share in (-1.0, 0.0, 1.0)]
    return bays.take(np.all(whole, axis=0))


def with_bay_lines(city: City, bays: Bays) -> City:
    """Paint the lines between bays, and those at the ends of rows, where there is asphalt."""
    ahead = np.column_stack([np.sin(bays.yaw), -np.cos(bays.yaw)])
    right = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    reach = (STALL / 2 - WITHIN) * ahead
    ends = np.concatenate(
        [np.stack([m - reach, m, m + reach], axis=1)
         for m in (bays.xy + side * right for side in (-BAY / 2, BAY / 2))]
    )  # fmt: skip
    # Neighbours share a line.
    spot = np.round(ends[:, 1] * 10).astype(np.int64)
    ends = ends[np.unique(spot, axis=0, return_index=True)[1]]
    under = stand_on(city.scene.meshes.get("ground"), ends.reshape(-1, 2)).label
    ends = ends[(under.reshape(-1, 3) == LABEL["parking"]).all(axis=1)]
    if not len(ends):
        return city
    lines = pack(shapely.linestrings(ends))
    mesh = painted_strips(city, lines, LINE, OVER, stable_id(LAYER))
    return replace(city, scene=city.scene.with_mesh(LAYER, mesh))
