"""Planted beds behind walks and at corners, before yards in town that no map describes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH, LABEL, SURFACES
from cityx.city.layout import in_town
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.clearance import near_any, spots_of
from cityx.geometry.polylines import Polylines, arc_lengths, every, locate, pack
from cityx.geometry.ranges import numbered_in_runs
from cityx.ground.arrangement import Regions, regions
from cityx.ids import hash_ids, uniform
from cityx.places.profile import Land
from cityx.road.ground.yards import grounds_digest, other_ways, told_areas, yard_patches
from cityx.road.network.network import node_corners
from cityx.system.remembered import Remembered

if TYPE_CHECKING:
    from cityx.city.layout import Layout
    from cityx.city.roads import RoadNetwork
    from cityx.road.surface.carriageway import Carriageway


PURPOSE = "ground/bed"
SLOT, LENGTH = 6.0, 4.6  # metres of walk per bed, and of the bed; one passes between two of them
DEPTH = 1.1  # metres
CORNER = 1.0  # metres, half a bed at a corner
SHARE = 0.8  # of the slots that have a bed
PASS = 1.2  # metres between two beds
BEHIND = 0.25  # metres of paving between the walk and a bed
LEAST_WALK = 1.5  # metres before a bed behind a footway of its own
FROM_HOUSE = 3.0  # metres; less before a facade is a wide pavement, and stays free
FROM_PATH = 0.2  # metres
TOWN_REACH = 30.0  # metres within which an urban building makes land a yard
SHARP = np.radians(140.0)  # arms that meet flatter leave no corner


@dataclass(frozen=True)
class Beds:
    """Rectangles behind walks, b of them.

    Attributes
    ----------
    id
        (b,) uint64.
    middle, along, half
        (b, 2) float; metres, unit vectors along the street, and half the sizes along and across.
    walk
        (b,) float, metres of the walk before each.
    """

    id: NDArray[np.uint64]
    middle: FloatArray
    along: FloatArray
    half: FloatArray
    walk: FloatArray

    def take(self, rows: Any) -> Beds:
        """Return the given beds (indices or mask)."""
        return Beds(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))

    @property
    def shapes(self) -> NDArray[Any]:
        """(b,) polygons."""
        u = self.along * self.half[:, :1]
        v = np.column_stack([-self.along[:, 1], self.along[:, 0]]) * self.half[:, 1:]
        corners = np.stack([-u - v, u - v, u + v, v - u], axis=1) + self.middle[:, None]
        return np.asarray(shapely.polygons(np.round(corners, 3)))


_LAST: Remembered[Beds] = Remembered()


def bed_slots(layout: Layout, network: RoadNetwork) -> Beds:
    """Draw places for beds along the backs of walks and at corners, clear of houses and paths.

    Some of them lie on what is driven on, or on another walk; the ground tells which. Those of the
    last layout are remembered.
    """
    parts = layout.roads, layout.areas
    return _LAST.get(lambda: _drawn(layout, network), parts, grounds_digest(layout, network))


def _drawn(layout: Layout, network: RoadNetwork) -> Beds:
    buildings = layout.buildings
    houses = buildings.geometry.to_numpy()
    urban = in_town(buildings)
    found = [*_behind_walks(layout, network), _at_corners(layout, network)]
    names = Beds.__dataclass_fields__
    beds = Beds(*(np.concatenate([getattr(some, name) for some in found]) for name in names))
    beds = beds.take(uniform(0, PURPOSE, beds.id) < SHARE)
    spots = spots_of(beds.middle)
    drawn = near_any(spots, houses[urban], TOWN_REACH)
    beds = beds.take(drawn & ~near_any(spots, houses, FROM_HOUSE + DEPTH / 2))
    beds = beds.take(_clear(beds, layout, network, houses))
    # Of two that leave no way between them the one of the street comes first.
    one, other = shapely.STRtree(beds.shapes).query(beds.shapes, "dwithin", PASS)
    return beds.take(~np.isin(np.arange(len(beds.id)), other[other > one]))


def _behind_walks(layout: Layout, network: RoadNetwork) -> list[Beds]:
    """Slots on both sides of streets with walks, and of footways that are walks."""
    lines = network.lines
    table = layout.roads.iloc[network.edge_road]
    found = []
    for sign, column in ((1.0, "sidewalk_left"), (-1.0, "sidewalk_right")):
        walk = table[column].to_numpy(float)
        chosen = np.flatnonzero(walk > 0)
        off = network.half_width + KERB_WIDTH + walk
        found.append(_slots(lines, network.edge_id, chosen, sign, off, walk, network.trim))
    roads = layout.roads
    told = roads["tags"].str.contains('"footway": *"sidewalk"', regex=True).to_numpy().astype(bool)
    told &= (roads["kind"] == "footway").to_numpy() & ~roads["tunnel"].to_numpy(bool)
    rows = np.flatnonzero(told)
    ways, ids = pack(roads.geometry.to_numpy()[rows]), roads["id"].to_numpy()[rows]
    off = np.fmax(roads["width"].to_numpy(float)[rows], 1.2) / 2
    for sign in (1.0, -1.0):
        every_one = np.arange(len(rows))
        found.append(_slots(ways, ids, every_one, sign, off, np.full(len(rows), LEAST_WALK)))
    return found


def _slots(
    lines: Polylines, ids: NDArray[np.uint64], chosen: IntArray, sign: float, off: FloatArray,
    walk: FloatArray, trim: FloatArray | None = None,
) -> Beds:  # fmt: skip
    """Slots along lines; `trim` is what junctions take of their ends, (n, 2) metres.

    Pieces of one line have its id, and their slots are numbered on.
    """
    length = arc_lengths(lines)[1]
    row, at = every(length[chosen], SLOT, SLOT / 2)
    row = chosen[row]
    number = numbered_in_runs(ids[row])
    if trim is not None:
        straight = (at > trim[row, 0] + SLOT / 2) & (at < length[row] - trim[row, 1] - SLOT / 2)
        row, at, number = row[straight], at[straight], number[straight]
    middle, ahead = locate(lines, row, at)
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    xy = middle + left * (sign * (off[row] + BEHIND + DEPTH / 2))[:, None]
    half = np.tile([LENGTH / 2, DEPTH / 2], (len(row), 1))
    return Beds(hash_ids(0, PURPOSE, ids[row], 2 * number + (sign > 0)), xy, ahead, half, walk[row])


def _at_corners(layout: Layout, network: RoadNetwork) -> Beds:
    """Square beds behind the walks of corners, one side across the bisector."""
    table = layout.roads.iloc[network.edge_road]
    walk = np.column_stack([table[name].to_numpy(float)
                            for name in ("sidewalk_left", "sidewalk_right")])  # fmt: skip
    lines = network.lines
    arms, corners, _ = node_corners(
        layout, table["kind"].to_numpy(), lines, network.edge_nodes, network.node_position,
        network.half_width,
    )  # fmt: skip
    one, other = corners.first, corners.second
    # A corner lies left of the arm that comes first, right of the next.
    near = walk[arms.edge[one], arms.end[one]], walk[arms.edge[other], 1 - arms.end[other]]
    wide = np.maximum(*near)
    rows = np.flatnonzero((np.minimum(*near) > 0) & (corners.gap < SHARP))
    one, gap, wide = one[rows], corners.gap[rows], wide[rows]
    bearing = arms.bearing[one] + gap / 2
    out = np.column_stack([np.cos(bearing), np.sin(bearing)])
    sine = np.maximum(np.sin(gap / 2), 0.1)
    behind = corners.radius[rows] * (1 / sine - 1) + KERB_WIDTH + wide + 2 * BEHIND + CORNER
    xy = np.round(corners.place[rows] + out * behind[:, None], 3)
    ids = hash_ids(0, f"{PURPOSE}/corner", network.edge_id[arms.edge[one]], arms.end[one])
    along = np.column_stack([-out[:, 1], out[:, 0]])
    return Beds(ids, xy, along, np.full((len(rows), 2), CORNER), wide)


def _clear(beds: Beds, layout: Layout, network: RoadNetwork, houses: NDArray[Any]) -> BoolArray:
    """(b,) whether beds keep their distances, and lie on land that no map describes."""
    clear = np.ones(len(beds.id), bool)
    tree = shapely.STRtree(beds.shapes)
    paths, half = other_ways(layout, network)
    for things, gap in ((houses, FROM_HOUSE), (paths, half + FROM_PATH), (told_areas(layout), 0.0)):
        clear[tree.query(things, predicate="dwithin", distance=gap)[1]] = False
    return clear


def bed_regions(layout: Layout, network: RoadNetwork, road: Carriageway, land: Land) -> Regions:
    """Return the beds that lie behind walks, not on them nor before bays, as regions."""
    if not network.edge_count:
        return Regions()
    beds = bed_slots(layout, network)
    shapes, gap = beds.shapes, KERB_WIDTH + beds.walk
    bed, _ = shapely.STRtree(road.driven).query(shapes, predicate="dwithin", distance=gap)
    free = np.ones(len(shapes), bool)
    free[bed] = False
    bays = yard_patches(layout, network, land).labelled("parking").shapes
    free[shapely.STRtree(shapes).query(bays, predicate="dwithin", distance=PASS)[1]] = False
    label = LABEL["bed"]
    return regions(shapes[free], label, SURFACES[label].priority)
