"""Edges of private land along walks in town: walls, fences, railings and hedges, plot by plot.

Where the land between a walk and the houses is wide, each plot is closed off in its own way, as
its region does; ways to doors, drives and car parks stay open.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.ground import Ground
from cityx.city.layout import in_town
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.clearance import near_any
from cityx.geometry.polylines import Polylines, arc_lengths, locate, pack, pieces, to_linestrings
from cityx.geometry.ranges import counted
from cityx.ground.arrangement import BEYOND
from cityx.ground.pieces import ids_of_places, ways_to_doors
from cityx.ids import choose
from cityx.places.profiles import profile_of
from cityx.system.remembered import Remembered

PURPOSE = "nature/frontages"
PUBLIC = ("sidewalk", "furnishing", "edging", "ramp", "landing", "guide_strip")
PRIVATE = ("courtyard", "grass", "gravel", "bare", "block")
# Hedges grow from soil: where the plot is paved, others stand.
SOFT = ("grass", "bare", "gravel", "block")
PLOT = 12.0  # metres of street that a plot takes at most: edge of the cells of a lattice
CORNER = 3.173  # metres, where its cells begin; few things lie along their sides
GATE = 0.65  # metres that stay open at each end of a plot
LEAST = 1.6  # metres of wall, fence or hedge; shorter ones are not built
DEEP = 1.7  # metres of private land that an edge needs behind it
BACK = 0.35  # metres behind the walk that an edge stands, so that its foot takes none of it
DOOR_HALF = 1.1  # metres to each side of a way to a door
DRIVE = 5.0  # metres before car parks in which nothing stands
TOWN_REACH = 30.0  # metres to an urban building
FINE = 0.08  # metres by which edges are simplified


@dataclass(frozen=True)
class Edges:
    """Edges of plots, n of them.

    Attributes
    ----------
    lines
        (n,) LineStrings, metres.
    id
        (n,) uint64.
    kind
        (n,) what each is built as, "" for one that is open.
    side
        (n,) where the plot lies: +1 on the left of the line, -1 on the right.
    """

    lines: NDArray[Any]
    id: NDArray[np.uint64]
    kind: NDArray[Any]
    side: FloatArray

    def take(self, rows: Any) -> Edges:
        """Return some of the edges, by mask or by index."""
        return Edges(self.lines[rows], self.id[rows], self.kind[rows], self.side[rows])


_LAST: Remembered[Edges] = Remembered()


def frontage_edges(city: City) -> Edges:
    """Return the edges between walks and private land; the last are remembered.

    Parameters
    ----------
    city
        City with its ground; facades tell where doors are.
    """
    doors = city.scene.instances.get("doors")
    parts = [part for part in (city.ground, city.layout, doors) if part is not None]
    return _LAST.get(lambda: _found(city), parts, city.seed, profile_of(city.frame))


def _found(city: City) -> Edges:
    nothing = np.zeros(0, object)
    none = Edges(nothing, np.zeros(0, np.uint64), nothing, np.zeros(0))
    ground = city.ground
    buildings = city.layout.buildings
    houses = buildings.geometry.to_numpy()
    urban = houses[in_town(buildings)]
    if ground is None or not len(urban) or "doors" not in city.scene.instances:
        return none
    land = profile_of(city.frame).land
    private = (*PRIVATE, "frontage") if land.own_frontage else PRIVATE
    plots = _plots(_rims(ground, private), urban)
    if not plots.count:
        return none
    middle, ahead = locate(plots, np.arange(plots.count), arc_lengths(plots)[1] / 2)
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    inward, deep = _inward(ground, private, middle, left)
    near = near_any(middle, urban, TOWN_REACH)
    kept = np.flatnonzero(deep & near)
    lines = to_linestrings(plots)[kept] if len(kept) else np.zeros(0, object)
    if not len(lines):
        return none
    ids = ids_of_places(middle[kept], PURPOSE)
    side = inward[kept]
    soft = ground.on(middle[kept] + (DEEP / 2 * side)[:, None] * left[kept], *SOFT)
    kinds = np.full(len(ids), "", object)
    for chosen, weights in ((soft, land.soft_edges), (~soft, land.paved_edges)):
        words = np.array(list(weights), object)
        drawn = words[choose(city.seed, PURPOSE, ids, list(weights.values()))]
        kinds[chosen] = drawn[chosen]
    moved = shapely.offset_curve(lines, BACK * side, join_style="mitre")
    return _opened(city, Edges(moved, ids, kinds, side))


def _rims(ground: Ground, labels: tuple[str, ...]) -> FloatArray:
    """(n, 2, 2) edges at which public walks meet private land."""
    left, right = ground.edge_faces.T.astype(np.int64)
    public = ground.labelled(*PUBLIC)
    # What the map describes has the edges that the map shows.
    private = ground.labelled(*labels) & (ground.face_object == 0)
    other = np.maximum(right, 0)
    rim = (right != BEYOND) & ((public[left] & private[other]) | (private[left] & public[other]))
    return np.asarray(ground.vertices[ground.edges[rim]])


def _plots(rims: FloatArray, urban: NDArray[Any]) -> Polylines:
    """Join edges within the cells of a lattice, a gate at each end: what changes changes nearby.

    Only cells near urban houses count.
    """
    none = Polylines(np.zeros((0, 2)), np.zeros(1, np.int64))
    if not len(rims):
        return none
    segments = shapely.linestrings(rims)
    low, high = (np.floor((each - CORNER) / PLOT).astype(np.int64)
                 for each in (rims.min(axis=1), rims.max(axis=1)))  # fmt: skip
    wide = high - low + 1
    row, number = counted(wide.prod(axis=1))
    step = np.column_stack([number // wide[row, 1], number % wide[row, 1]])
    order = np.lexsort((row, step[:, 1], step[:, 0]))
    row, cell = row[order], (low[row] + step)[order]
    every, of = np.unique(cell, axis=0, return_inverse=True)
    middle = (every + 0.5) * PLOT + CORNER
    near = near_any(middle, urban, TOWN_REACH + PLOT)[of.ravel()]
    row, cell = row[near], cell[near]
    corner = cell * PLOT + CORNER
    cut = shapely.intersection(segments[row], shapely.box(*corner.T, *(corner + PLOT).T))
    kept = np.flatnonzero(shapely.length(cut) > 1e-6)
    owner = np.unique(cell[kept], axis=0, return_inverse=True)[1]
    order = np.argsort(owner, kind="stable")
    joined = shapely.multilinestrings(cut[kept[order]], indices=owner[order])
    merged = shapely.normalize(shapely.get_parts(shapely.line_merge(joined)))
    lines = pack(shapely.simplify(merged[shapely.length(merged) > LEAST + 2 * GATE], FINE))
    length = arc_lengths(lines)[1]
    every_one = np.arange(lines.count)
    return pieces(lines, every_one, np.full(lines.count, GATE), length - GATE)


def _inward(
    ground: Ground, labels: tuple[str, ...], middle: FloatArray, left: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """(n,) side of private land, +1 left, and whether it is deep enough there."""
    deep = []
    for sign in (1.0, -1.0):
        probe = [ground.on(middle + sign * off * left, *labels) for off in (0.5, DEEP)]
        deep.append(probe[0] & probe[1])
    return np.where(deep[0], 1.0, -1.0), deep[0] ^ deep[1]


def _opened(city: City, edges: Edges) -> Edges:
    """Leave out what stands before doors, car parks and walls."""
    assert city.ground is not None
    ground = city.ground
    lines, owner = edges.lines, np.arange(len(edges.lines))
    doors = ways_to_doors(city)
    door, line = shapely.STRtree(lines).query(doors, predicate="dwithin", distance=DOOR_HALF)
    if len(line):
        order = np.lexsort((door, line))
        door, line = door[order], line[order]
        hit, start = np.unique(line, return_index=True)
        strips = shapely.buffer(doors[door], DOOR_HALF, cap_style="square", quad_segs=2)
        lines = lines.copy()
        for row, group in zip(hit, np.split(strips, start[1:]), strict=True):
            lines[row] = shapely.difference(lines[row], shapely.union_all(group))
    parts, index = shapely.get_parts(lines, return_index=True)
    good = (shapely.get_type_id(parts) == 1) & (shapely.length(parts) > LEAST)
    parts, owner = parts[good], owner[index[good]]
    lots = ground.triangles_of("parking")
    bays = shapely.polygons(ground.vertices[lots]) if len(lots) else np.zeros(0, object)
    houses = city.layout.buildings.geometry.to_numpy()
    free = np.ones(len(parts), bool)
    for things, gap in ((bays, DRIVE), (houses, 0.6)):
        if len(things) and len(parts):
            found = shapely.STRtree(things).query(parts, predicate="dwithin", distance=gap)[0]
            free[found] = False
    rows = owner[free]
    return Edges(parts[free], edges.id[rows], edges.kind[rows], edges.side[rows])
