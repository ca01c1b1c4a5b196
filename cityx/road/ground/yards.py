"""Yards: land behind walks and between houses in town, laid out along its edges.

Plots along a street are lawns, gravel or bays square to it, one beside the other, with ways to the
houses between them. Courts behind houses are lawns or gravel up to the paving along their walls.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH, LABEL
from cityx.city.layout import Layout, in_town
from cityx.city.roads import RoadNetwork
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.clearance import near_any
from cityx.geometry.polylines import arc_lengths, every, locate, to_linestrings
from cityx.geometry.ranges import numbered_in_runs
from cityx.ground.arrangement import Regions, join_regions, regions
from cityx.ids import choose, hash_ids
from cityx.places.profile import Land, Weights
from cityx.system.digests import arrays_digest
from cityx.system.remembered import Remembered

PURPOSE = "ground/plot"
SLOT = 12.5  # metres of street per plot
GATE = 9.0  # metres from a node to the middle of the first plot at least
TOWN_REACH = 40.0  # metres from a house of a town up to which plots are laid out
BEHIND = 0.15  # metres from the walk to a plot; its edging lies there
FROM_PATH = 0.5  # metres beside a path
UNTOLD = ("residential", "commercial", "retail", "industrial", "mixed")  # use, and no surface
# What plots are made of; each hides those before it. Bare ground is planted with shrubs.
LABELS = ("", "grass", "gravel", "bare", "parking")
BAY, STALL = 2.5, 5.0  # metres, width and length of a parking bay
# Metres along and away from the street, from the least to the largest; the last that fits is laid.
_SOFT = ((4.0, 2.2), (6.0, 2.2), (9.6, 2.2), (9.6, 3.6), (9.6, 5.5), (9.6, 8.0))
SIZES = (((0.0, 0.0),), _SOFT, _SOFT, _SOFT[:4],
         ((2 * BAY, STALL), (4 * BAY, STALL), (4 * BAY, 2 * STALL + 6.0)))  # fmt: skip
MANY_CARS = ("primary", "secondary", "trunk", "motorway", "primary_link", "secondary_link",
             "trunk_link", "motorway_link")  # fmt: skip
FORECOURT = 8.5  # metres behind walks that plots take, and none of the courts behind them
SERVICE = 1.2  # metres beside a way that has no walk
CELL = 50.0  # metres; courts are those of the cells about houses of a town
NARROW = 1.6  # metres, half of the least breadth of a court's lawn
LEAST_COURT = 24.0  # square metres
MOST_PAVED = 2000.0  # square metres of a court; larger ones are lawns
FINE = 0.3  # metres by which outlines of courts are simplified
PRIORITY = 2  # of the first label; all lie below gardens and what a map shows


@dataclass(frozen=True)
class Patches:
    """Rectangles along streets, p of them.

    Attributes
    ----------
    id
        (p,) uint64.
    middle
        (p, 2) float.
    along
        (p, 2) float, unit vector along the street, which lies on its right.
    size
        (p, 2) float, metres along and across.
    label
        (p,) label of the ground.
    """

    id: NDArray[np.uint64]
    middle: FloatArray
    along: FloatArray
    size: FloatArray
    label: NDArray[np.int64]

    def take(self, rows: Any) -> Patches:
        """Return the given patches (indices or mask)."""
        return Patches(self.id[rows], self.middle[rows], self.along[rows], self.size[rows],
                       self.label[rows])  # fmt: skip

    def labelled(self, name: str) -> Patches:
        """Return the patches of one label, by name."""
        return self.take(self.label == LABEL[name])

    @property
    def shapes(self) -> NDArray[Any]:
        """(p,) polygons."""
        u = self.along * self.size[:, :1] / 2
        v = np.column_stack([-self.along[:, 1], self.along[:, 0]]) * self.size[:, 1:] / 2
        corners = np.stack([-u - v, u - v, u + v, v - u], axis=1) + self.middle[:, None]
        return np.asarray(shapely.polygons(np.round(corners, 3)))


_LAST: Remembered[Patches] = Remembered()


def yard_patches(layout: Layout, network: RoadNetwork, land: Land) -> Patches:
    """Draw plots along streets in town, clear of walls, walks and paths.

    They depend on their place alone, and on what is near. Those of the last layout are remembered.

    Parameters
    ----------
    layout
        The layout.
    network
        Its roads.
    land
        Of the profile of the place.
    """
    key = land, layout.extent, grounds_digest(layout, network)
    parts = [layout.roads, layout.areas]
    return _LAST.get(lambda: _drawn(layout, network, land), parts, *key)


def grounds_digest(layout: Layout, network: RoadNetwork) -> bytes:
    """Return a hash of the houses and streets that what is drawn between them depends on."""
    houses = layout.buildings
    urban = in_town(houses)
    lines = network.points, network.point_start, network.half_width, network.edge_road
    return arrays_digest(houses.geometry.to_numpy(), urban, network.edge_id, *lines)


def _weights(kinds: Weights) -> list[float]:
    """Return weights in the order of `LABELS`."""
    return [kinds.get(name, 0.0) for name in LABELS]


def _walks(layout: Layout, network: RoadNetwork) -> tuple[FloatArray, FloatArray]:
    """Return, for each edge, (e, 2) metres from its centre line to the backs of its walks."""
    table = layout.roads.iloc[network.edge_road]
    walk = np.column_stack(
        [table[f"sidewalk_{side}"].to_numpy(float) for side in ("left", "right")]
    )
    kerbed = np.where(walk > 0, KERB_WIDTH, 0.0)
    return network.half_width[:, None] + kerbed + walk, walk


def _drawn(layout: Layout, network: RoadNetwork, land: Land) -> Patches:
    buildings = layout.buildings
    houses = buildings.geometry.to_numpy()
    urban = houses[in_town(buildings)]
    none = np.zeros((0, 2))
    if not len(urban) or not network.edge_count:
        return Patches(np.zeros(0, np.uint64), none, none, none, np.zeros(0, np.int64))
    table = layout.roads.iloc[network.edge_road]
    flat = (table["layer"].to_numpy() == 0) & ~table["bridge"].to_numpy(bool)
    flat &= ~table["tunnel"].to_numpy(bool) & ~table["roundabout"].to_numpy(bool)
    lines, (back, _) = network.lines, _walks(layout, network)
    found = []
    for column, sign in enumerate((1.0, -1.0)):
        margin = np.maximum(GATE, network.trim[flat].max(axis=1) + SLOT / 2)
        row, at = every(arc_lengths(lines)[1][flat], SLOT, margin)
        row = np.flatnonzero(flat)[row]
        number = numbered_in_runs(network.edge_id[row])  # pieces of one edge are numbered on
        middle, ahead = locate(lines, row, at)
        left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
        front = middle + sign * (back[row, column] + BEHIND)[:, None] * left
        # Two plots side by side are one yard.
        yard = hash_ids(0, PURPOSE, network.edge_id[row], 4 * (number // 2) + (sign > 0))
        ids = hash_ids(0, PURPOSE, network.edge_id[row], 4 * number + 2 + (sign > 0))
        busy = table["kind"].isin(MANY_CARS).to_numpy()[row]
        found.append((ids, yard, front, sign * ahead, busy))
    ids, yard, front, along, busy = (np.concatenate(part) for part in zip(*found, strict=True))
    xmin, ymin, xmax, ymax = layout.extent
    inside = (front >= (xmin, ymin)).all(axis=1) & (front <= (xmax, ymax)).all(axis=1)
    inside &= near_any(front, urban, TOWN_REACH)
    kind = choose(0, PURPOSE, yard, _weights(land.plots))
    kind = np.where(busy & (kind == LABELS.index("parking")), LABELS.index("bare"), kind)
    rows = np.flatnonzero(inside & (kind > 0))
    return _fitted(ids[rows], front[rows], along[rows], kind[rows], layout, network, land)


def _fitted(
    ids: NDArray[np.uint64], front: FloatArray, along: FloatArray, kind: NDArray[np.int64],
    layout: Layout, network: RoadNetwork, land: Land,
) -> Patches:  # fmt: skip
    """Return the plots that have room, each at the largest of its sizes that does."""
    inward = np.column_stack([-along[:, 1], along[:, 0]])
    label = np.array([LABEL[name or "courtyard"] for name in LABELS])[kind]
    chosen = Patches(ids, front.copy(), along, np.zeros((len(ids), 2)), label)
    fits = np.ones(len(ids), bool)
    for step in range(max(len(sizes) for sizes in SIZES)):
        size = np.array([sizes[min(step, len(sizes) - 1)] for sizes in SIZES])[kind]
        rows = np.flatnonzero(fits)
        middle = front[rows] + inward[rows] * (size[rows, 1:] / 2)
        tried = Patches(ids[rows], middle, along[rows], size[rows], label[rows])
        room = _clear(tried.shapes, layout, network, land)
        fits[rows[~room]] = False
        chosen.size[rows[room]], chosen.middle[rows[room]] = size[rows[room]], middle[room]
    chosen = chosen.take(chosen.size[:, 0] > 0)
    # Of two that lie on one another, as at corners, that of the higher id gives way.
    shapes = chosen.shapes
    one, other = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=BEHIND)
    return chosen.take(~np.isin(np.arange(len(shapes)), one[chosen.id[one] > chosen.id[other]]))


def told_areas(layout: Layout) -> NDArray[Any]:
    """Return the areas of which the map says what covers them."""
    areas = layout.areas
    return np.asarray(areas.geometry.to_numpy()[~areas["kind"].isin(UNTOLD).to_numpy()])


def other_ways(layout: Layout, network: RoadNetwork) -> tuple[NDArray[Any], FloatArray]:
    """Return ways that are no edges of the network, with half of their widths."""
    other = np.ones(len(layout.roads), bool)
    other[network.edge_road] = False
    width = layout.roads["width"].to_numpy(float)[other]
    return layout.roads.geometry.to_numpy()[other], np.fmax(width, 1.2) / 2


def _clear(
    shapes: NDArray[Any], layout: Layout, network: RoadNetwork, land: Land
) -> BoolArray:  # fmt: skip
    """(p,) whether plots keep their distances, and lie on land that no map describes."""
    clear = np.ones(len(shapes), bool)
    tree = shapely.STRtree(shapes)
    paths, half = other_ways(layout, network)
    back = _walks(layout, network)[0].max(axis=1)
    for things, gap in (
        (layout.buildings.geometry.to_numpy(), land.wall_gap),
        (paths, half + FROM_PATH),
        (to_linestrings(network.lines), network.half_width + 0.1),
        (told_areas(layout), 0.0),
    ):
        reach = np.broadcast_to(np.asarray(gap, float), len(things))
        clear[tree.query(things, predicate="dwithin", distance=reach)[1]] = False
    # No corner lies on another street's walk; the own one runs along the plot.
    centre = to_linestrings(network.lines)
    line, shape = tree.query(centre, predicate="dwithin", distance=back)
    over = shapely.area(shapely.intersection(
        shapely.buffer(centre[line], back[line], cap_style="flat", quad_segs=2), shapes[shape]
    ))  # fmt: skip
    clear[shape[over > 0.3]] = False
    return clear


def court_zones(layout: Layout, network: RoadNetwork, land: Land) -> tuple[NDArray[Any], Any]:
    """Return lawns and gravel of courts behind houses: polygons, and their (z,) kinds of `LABELS`.

    What is left where walls, walks, ways and plots keep their paving.
    """
    buildings = layout.buildings
    houses = buildings.geometry.to_numpy()
    urban = houses[in_town(buildings)]
    if not len(urban) or not network.edge_count:
        return np.zeros(0, object), np.zeros(0, np.int64)
    box = shapely.bounds(urban)
    cell = np.unique(np.floor((box[:, :2] + box[:, 2:]) / (2 * CELL)).astype(np.int64), axis=0)
    spread = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)])
    low = np.unique((cell[:, None] + spread).reshape(-1, 2), axis=0) * CELL
    about = shapely.unary_union(shapely.box(*low.T, *(low + CELL).T))
    about = shapely.intersection(about, shapely.box(*layout.extent))
    back, walk = _walks(layout, network)
    reach = back.max(axis=1) + np.where(walk.max(axis=1) > 0, FORECOURT, SERVICE)
    paths, half = other_ways(layout, network)
    style = {"join_style": "mitre", "mitre_limit": 2.0}
    plain = shapely.simplify(houses, FINE)
    hard = [
        shapely.buffer(plain, land.wall_gap, **style),
        shapely.buffer(to_linestrings(network.lines), reach, quad_segs=2),
        shapely.buffer(paths, half + FROM_PATH, quad_segs=2, cap_style="flat"),
        shapely.buffer(yard_patches(layout, network, land).shapes, 1.2, **style),
        told_areas(layout),
    ]
    taken = shapely.unary_union(np.concatenate(hard))
    left = shapely.buffer(shapely.difference(about, taken), -NARROW, **style)
    left = shapely.simplify(shapely.buffer(left, NARROW, **style), FINE)
    zones = shapely.get_parts(left)
    zones = zones[shapely.area(zones) > LEAST_COURT]
    if not len(zones):
        return zones, np.zeros(0, np.int64)
    # The house that is nearest to a court's middle says what becomes of it.
    spots = shapely.point_on_surface(zones)
    zone, house = shapely.STRtree(urban).query_nearest(spots, all_matches=False)
    corner = np.round(shapely.bounds(urban)[house, :2] * 10).astype(np.int64).view(np.uint64)
    key = hash_ids(0, f"{PURPOSE}/court", corner[:, 0], corner[:, 1])
    kind = np.zeros(len(zones), np.int64)
    kind[zone] = choose(0, f"{PURPOSE}/court", key, _weights(land.courts))
    kind[shapely.area(zones) > MOST_PAVED] = LABELS.index("grass")
    return zones[kind > 0], kind[kind > 0]


def patch_regions(layout: Layout, network: RoadNetwork, land: Land) -> Regions:
    """Return plots and courts as regions of the ground."""
    patches = yard_patches(layout, network, land)
    rank = np.array([LABEL[name or "courtyard"] for name in LABELS])
    order = (patches.label[:, None] == rank).argmax(axis=1)
    zones, kind = court_zones(layout, network, land)
    return join_regions([
        regions(patches.shapes, patches.label, PRIORITY + order),
        regions(zones, rank[kind], PRIORITY),
    ])  # fmt: skip
