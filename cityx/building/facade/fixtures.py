"""Fixtures: the things of real size that a look puts on walls, roofs and plots."""

from __future__ import annotations

from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.fixtures import fixture
from cityx.assets.styles.facade_styles import Fixture
from cityx.building.catalogue import looks
from cityx.building.facade import grammar as facades
from cityx.building.facade.dressing import corner_reach, following_walls
from cityx.building.facade.fronts import STREETS
from cityx.building.facade.grammar import bays_of
from cityx.building.facade.placing import Placing
from cityx.building.facade.strips import TINTS
from cityx.building.facade.walls import WallTable
from cityx.building.shops.signs import SIGNS
from cityx.city.ground import KERB_WIDTH
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import numbered
from cityx.geometry.scatter import near_pairs
from cityx.ground.walking.passage import FREE
from cityx.ids import hash_ids, uniform

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

    from cityx.building.facade.facade_plan import Facade
    from cityx.city.city import City

MARGIN = 0.25  # metres of a party wall below which a wall is free
LEAST_WALL = 1.2  # metres
EDGE_MARGIN = 0.4  # metres between things along an edge and its ends
GABLE_TURN = 0.97  # cosine between a gable's normal and the ridge
LEAST_GABLE = 1.0  # metres of roof
OVERLAP = 0.15  # metres by which a thing may stand out beyond the end of its wall
HEADROOM = 2.6  # metres above which a thing is in no door's way
PAVEMENT = 0.35  # metres; what stands out less takes nothing from the pavement
STEPS = 2.2  # metres that the steps of a door may take of it
DOOR_GAP = 0.15  # metres between a door and what stands beside it
FAR = 1e5  # metres; longer than any wall
SHARP = 0.3  # of the mitre of a right angle; flatter corners bear nothing
BESIDE = 0.35  # cosine between the front's normal and that of a wall beside it, at most
WINDOWS = (facades.WINDOW, facades.BACK, facades.GROUND, facades.FRENCH)


def fixtures(placing: Placing, found: Facade, city: City) -> None:
    """Put the fixtures of every look in place."""
    style, seed = found.designs.style, city.seed
    site = Site(found, city.layout.roads)
    for key in np.unique(style).tolist():
        parts = np.flatnonzero(style == key)
        for number, each in enumerate(looks()[key].facade.fixtures):
            having = np.zeros(len(style), bool)
            having[parts] = True
            if not each.scattered:
                drawn = uniform(seed, f"facade/fixture/{key}/{number}", found.volumes.building)
                having &= drawn < each.share
            _place(placing, site, seed, each, having, f"{key}/{number}")


class Site:
    """A facade with what several fixtures ask of it.

    A class because each fact is worked out over the whole city, once, and only if a look asks.
    """

    def __init__(self, found: Facade, roads: GeoDataFrame) -> None:
        self.found = found
        self.roads = roads

    @cached_property
    def streets(self) -> tuple[NDArray[Any], FloatArray]:
        """Centrelines of streets on the ground, half widths with what stays free of walks."""
        kind, below = self.roads["kind"].to_numpy(str), self.roads["tunnel"].to_numpy(bool)
        driven = np.isin(kind, list(STREETS)) & (kind != "pedestrian") & ~below
        walk = np.fmax(*(self.roads[f"sidewalk_{side}"].to_numpy(float)
                         for side in ("left", "right")))  # fmt: skip
        half = np.nan_to_num(self.roads["width"].to_numpy(float) / 2)
        half = half + np.where(walk > 0, np.fmin(walk, FREE) + KERB_WIDTH, 0.0)
        return self.roads.geometry.to_numpy()[driven], half[driven]

    @cached_property
    def reach(self) -> tuple[FloatArray, FloatArray]:
        """As of `corner_reach`."""
        return corner_reach(self.found.walls)

    @cached_property
    def before_streets(self) -> NDArray[np.bool_]:
        """(w,) whether the wall before a wall of its part faces a street."""
        following, joined = following_walls(self.found.walls)
        before = np.zeros(self.found.walls.count, bool)
        before[following[joined]] = self.found.fronts.street[joined]
        return before

    @cached_property
    def bays(self) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
        """As of `bays_of`."""
        return bays_of(self.found.storey_walls, self.found.fronts)

    @cached_property
    def boxes(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Of all parts, as of `_boxes`."""
        return _boxes(self.found.volumes.polygons)

    @cached_property
    def gables(self) -> NDArray[np.bool_]:
        """(w,) whether a wall under a roof looks along the longer side of its part."""
        return _under_gables(self.found, self.boxes)

    @cached_property
    def sides(self) -> NDArray[np.bool_]:
        """(w,) whether a wall runs away from the wall with its building's main door."""
        return _beside_fronts(self.found)

    @cached_property
    def ways(self) -> tuple[facades.Openings, Any]:
        """Doors and shopfronts, and a tree of their places on walls."""
        table = self.found.openings
        low = table.take(np.isin(table.role, (*facades.DOORS, facades.SHOP)))
        return low, shapely.STRtree(shapely.points(low.wall.astype(float) * FAR, low.along))

    @cached_property
    def taken(self) -> NDArray[np.bool_]:
        """(w,) whether a wall has a door or a shopfront."""
        taken = np.zeros(self.found.walls.count, bool)
        taken[self.ways[0].wall] = True
        return taken

    @cached_property
    def windows(self) -> facades.Openings:
        """All windows."""
        table = self.found.openings
        return table.take(np.isin(table.role, WINDOWS))


def _place(
    placing: Placing, site: Site, seed: int, each: Fixture, having: NDArray[np.bool_], key: str
) -> None:
    found = site.found
    if each.at in ("top", "ground"):
        _on_plan(placing, site, seed, each, np.flatnonzero(having))
        return
    walls = found.walls
    usable = having[walls.part] & (walls.length > LEAST_WALL)
    if each.street is not None:
        usable &= found.fronts.street == each.street
    if not usable.any():
        return
    if each.at == "door":
        doors = found.openings.take(found.openings.role == facades.DOOR)
        doors = doors.take(usable[doors.wall])
        wall, along, z, index = doors.wall, doors.along, doors.low, doors.floor * 0
        mesh = fixture(each.name, detail=placing.detail).mesh.vertices
        under = z + each.lift + float(mesh[:, 2].max()) < walls.z_high[wall] + OVERLAP
        wall, along, z, index = wall[under], along[under], z[under], index[under]
    elif each.at == "front":
        wall = np.flatnonzero(usable & found.fronts.door)
        along, z = walls.length[wall] / 2, found.fronts.foot[wall]
        index = np.zeros(len(wall), np.int64)
    elif each.at == "corner":
        free = usable & (walls.blind_to < walls.z_low + MARGIN)
        free &= site.reach[0] > SHARP
        if each.street:
            free &= site.before_streets
        wall = np.flatnonzero(free)
        wall = _apart(walls, wall, each.spacing) if each.spacing else wall
        along, z = np.zeros(len(wall)), found.fronts.foot[wall]
        index = np.zeros(len(wall), np.int64)
    elif each.at == "window":
        table = _windows(site, each, usable)
        wall, along, z, index = table.wall, table.along, table.low, table.floor * 4096 + table.bay
        size = table.width, table.height
    elif each.at in ("edge", "foot", "gable", "side"):
        wall, along, index = _along_edges(site, each, usable)
        z = found.fronts.foot[wall] if each.at == "foot" else walls.z_high[wall]
        clear = _has_room(site, placing, each, wall, along)
        wall, along, z, index = wall[clear], along[clear], z[clear], index[clear]
    else:
        wall, along, z, index = _in_bays(site, each, usable)
        mesh = fixture(each.name, detail=placing.detail).mesh.vertices
        if each.at == "pier" and not each.stretch and not each.before and mesh[:, 1].min() < 0:
            reach = float(np.abs(mesh[:, 0]).max())
            kept = (index // 4096 > found.storeys.first[wall]) | (each.lift > HEADROOM)
            kept |= _clear_of_doors(site, wall, along, reach)
            wall, along, z, index = wall[kept], along[kept], z[kept], index[kept]
    if each.at != "window":
        clear = _off_streets(site, placing, each, wall, along)
        wall, along, z, index = wall[clear], along[clear], z[clear], index[clear]
        size = np.ones(len(wall)), np.ones(len(wall))
    if each.scattered:
        draw = uniform(seed, f"facade/fixture/{key}", placing.ids(each.name, wall, index))
        kept = draw < each.share
        wall, along, z, index = wall[kept], along[kept], z[kept], index[kept]
        size = size[0][kept], size[1][kept]
    part = walls.part[wall].astype(np.int64)
    scale = _scale(site, each, wall, index // 4096, size)
    if each.stretch == "round":
        deep = -float(fixture(each.name, detail=placing.detail).mesh.vertices[:, 1].min())
        before, after = (deep * share[wall] for share in site.reach)
        scale = walls.length[wall] + before + after, 1.0, 1.0
        along = along + (after - before) / 2
    placing.add(
        each.name, partial(fixture, each.name), wall, along, z + each.lift, scale=scale,
        tint=_tint(found, seed, each, part), index=index, out=each.out, reach=0.3,
    )  # fmt: skip


def _apart(walls: WallTable, wall: IntArray, spacing: float) -> IntArray:
    """Leave out corners of a part that lie nearer than `spacing` metres to one before them."""
    if not len(wall):
        return wall
    pairs = np.sort(near_pairs(walls.start[wall], spacing), axis=1)
    same = walls.part[wall[pairs[:, 0]]] == walls.part[wall[pairs[:, 1]]]
    return np.delete(wall, pairs[same, 1])


def _windows(site: Site, each: Fixture, usable: NDArray[np.bool_]) -> facades.Openings:
    """Windows of a range of storeys, in each so-manyth bay."""
    found, table = site.found, site.windows
    count = found.storeys.count[table.wall]
    low, high = _storey(count, each.first), _storey(count, each.last)
    kept = usable[table.wall] & (table.floor >= low) & (table.floor <= high)
    kept &= (table.bay % each.every == each.every // 2) & ((table.floor - low) % each.floors == 0)
    return table.take(kept)


def _scale(
    site: Site, each: Fixture, wall: IntArray, storey: IntArray,
    size: tuple[FloatArray, FloatArray],
) -> tuple[object, object, object]:  # fmt: skip
    """Scale of things: `storey` counts from below, `size` is that of the windows they stand at."""
    found, walls = site.found, site.found.walls
    if each.stretch == "opening":
        return size[0], 1.0, size[1]
    if each.stretch in ("storey", "cell"):
        floor = found.storeys.floor_of
        wide = site.bays[2][wall] if each.stretch == "cell" else 1.0
        return wide, 1.0, floor(wall, storey + 1) - floor(wall, storey)
    if each.stretch == "wall":
        return walls.length[wall], 1.0, 1.0
    if each.stretch == "bay":
        return site.bays[2][wall], 1.0, 1.0
    if each.stretch == "gable":
        part = walls.part[wall]
        return walls.length[wall], 1.0, (found.volumes.top - found.volumes.eave)[part]
    if each.stretch == "height":
        foot = np.maximum(found.fronts.foot[wall], walls.z_low[wall])
        return 1.0, 1.0, np.maximum(walls.z_high[wall] - foot - each.lift, 0.1)
    return 1.0, 1.0, 1.0


def _tint(found: Facade, seed: int, each: Fixture, part: IntArray) -> NDArray[np.float32]:
    if each.tint == "sign":
        ids = found.volumes.building[part]
        return np.asarray(SIGNS[hash_ids(seed, "facade/fixture sign", ids) % np.uint64(len(SIGNS))])
    if not each.tint:
        return np.ones((len(part), 3), np.float32)
    return np.asarray(getattr(found.finishes, TINTS[each.tint])[part], np.float32)


def _storey(count: IntArray, number: int) -> IntArray:
    return count + number if number < 0 else np.full(len(count), number)


def _in_bays(
    site: Site, each: Fixture, usable: NDArray[np.bool_]
) -> tuple[IntArray, FloatArray, FloatArray, IntArray]:
    """Places in bays, or at the piers between them, of a range of storeys."""
    found, walls, storeys = site.found, site.found.walls, site.found.storeys
    bays, margin, width, _ = site.bays
    rows = np.flatnonzero(usable & (bays > 0))
    low = np.maximum(_storey(storeys.count[rows], each.first), storeys.first[rows])
    high = np.minimum(_storey(storeys.count[rows], each.last), storeys.count[rows] - 1)
    if each.at == "head":
        low = high = storeys.count[rows] - 1
    columns = bays[rows] + (1 if each.at == "pier" else 0)
    number = np.maximum(high - low + 1, 0) * columns
    row = np.repeat(np.arange(len(rows)), number)
    cell = numbered(number)
    bay, storey = cell % columns[row], np.asarray(low[row] + cell // columns[row], np.int64)
    wall = rows[row]
    shift = 0.0 if each.at == "pier" else 0.5
    along = np.clip(margin[wall] + (bay + shift) * width[wall], 0.1, walls.length[wall] - 0.1)
    floor = storeys.floor_of(wall, storey)
    z = np.where(storey == storeys.first[wall], np.maximum(floor, found.fronts.foot[wall]), floor)
    covered = (z < walls.blind_to[wall] + 0.1) & (walls.blind_to[wall] > walls.z_low[wall] + 0.05)
    if each.at == "head":
        z, covered = walls.z_high[wall], walls.blind_to[wall] > walls.z_high[wall] - 0.4
    kept = (bay % each.every == each.every // 2) & ~covered
    kept &= (storey - low[row]) % each.floors == 0
    # What would stand in the way of a door or a shopfront is left out.
    if each.at == "bay" and not each.before:
        kept &= ~(site.taken[wall] & (storey == storeys.first[wall]) & (each.first == 0))
    return wall[kept], along[kept], z[kept], (storey * 4096 + bay)[kept]


def _along_edges(
    site: Site, each: Fixture, usable: NDArray[np.bool_]
) -> tuple[IntArray, FloatArray, IntArray]:
    walls = site.found.walls
    if each.at == "foot":
        open_ = walls.blind_to < walls.z_low + MARGIN
    elif each.at == "gable":
        open_ = site.gables
    elif each.at == "side":
        open_ = site.sides
    else:
        open_ = walls.blind_to < walls.z_high - 0.4
    rows = np.flatnonzero(usable & open_)
    run = walls.length[rows] - 2 * EDGE_MARGIN
    spacing = each.spacing or np.inf
    count = np.where(run > 0, np.maximum(1, np.floor(run / spacing)), 0).astype(np.int64)
    row = np.repeat(np.arange(len(rows)), count)
    number = numbered(count)
    along = EDGE_MARGIN + (number + 0.5) * run[row] / count[row]
    return rows[row], along, number


def _beside_fronts(found: Facade) -> NDArray[np.bool_]:
    """(w,) whether a wall runs away from the wall with its building's main door."""
    walls = found.walls
    building = found.volumes.building[walls.part]
    doors = np.flatnonzero(found.fronts.door)
    if not len(doors):
        return np.zeros(walls.count, bool)
    doors = doors[np.argsort(building[doors], kind="stable")]
    at = np.minimum(np.searchsorted(building[doors], building), len(doors) - 1)
    ahead = np.abs((walls.normal * walls.normal[doors[at]]).sum(axis=1))
    return np.asarray((building[doors[at]] == building) & (ahead < BESIDE))


def _under_gables(
    found: Facade, boxes: tuple[FloatArray, FloatArray, FloatArray]
) -> NDArray[np.bool_]:
    """(w,) whether a wall under a roof looks along the longer side of its part."""
    volumes, walls = found.volumes, found.walls
    middle, axis, _ = boxes
    unit = axis / np.maximum(np.hypot(*axis.T), 1e-9)[:, None]
    part = walls.part.astype(np.int64)
    ahead = np.abs((walls.normal * unit[part]).sum(axis=1)) > GABLE_TURN
    at = (walls.start + walls.end) / 2 - middle[part]
    # The middle of the gable is that of the part; what lies beside it is another wall.
    beside = np.abs(at[:, 0] * unit[part, 1] - at[:, 1] * unit[part, 0])
    roofed = (volumes.top - volumes.eave)[part] > LEAST_GABLE
    return np.asarray(roofed & ahead & (beside < 0.15 * walls.length))


def _has_room(
    site: Site, placing: Placing, each: Fixture, wall: IntArray, along: FloatArray
) -> NDArray[np.bool_]:
    """(k,) whether things of real size end before their walls do, and keep clear of doors."""
    if each.stretch in ("wall", "gable", "round") or not len(wall):
        return np.ones(len(wall), bool)
    mesh = fixture(each.name, detail=placing.detail).mesh.vertices
    reach = float(np.abs(mesh[:, 0]).max())
    length = site.found.walls.length[wall]
    fits = (along - reach > -OVERLAP) & (along + reach < length + OVERLAP)
    if each.at != "foot" or each.lift > HEADROOM:
        return np.asarray(fits)
    return np.asarray(fits & _clear_of_doors(site, wall, along, reach))


def _off_streets(
    site: Site, placing: Placing, each: Fixture, wall: IntArray, along: FloatArray
) -> NDArray[np.bool_]:
    """(k,) whether what stands before a wall, as a canopy on posts does, stands on no street."""
    clear = np.ones(len(wall), bool)
    mesh = fixture(each.name, detail=placing.detail).mesh.vertices
    posts = mesh[mesh[:, 2] + each.lift < HEADROOM]
    out = each.out - float(posts[:, 1].min(initial=0.0))
    # Steps belong to their door, and what hangs above the ground floor is in nobody's way.
    least = STEPS if each.at == "door" else PAVEMENT
    if each.stretch or each.first > 0 or out < least or not len(wall):
        return clear
    unit, normal = placing.unit[wall], site.found.walls.normal[wall]
    side = float(np.abs(posts[:, 0]).max()) * unit
    foot = site.found.walls.start[wall] + unit * along[:, None]
    ends = [foot - side, foot + side, foot + side + out * normal, foot - side + out * normal]
    lines, half = site.streets
    plans = shapely.STRtree(shapely.polygons(np.stack(ends, axis=1)))
    clear[plans.query(lines, "dwithin", half)[1]] = False
    return clear


def _clear_of_doors(
    site: Site, wall: IntArray, along: FloatArray, reach: float
) -> NDArray[np.bool_]:
    """(k,) whether what reaches so far to either side stands in the way of no door or shopfront."""
    low, tree = site.ways
    half = float(low.width.max()) / 2 if low.count else 0.0
    row, opening = tree.query(
        shapely.points(wall.astype(float) * FAR, along), "dwithin", reach + half + DOOR_GAP
    )
    gap = np.abs(along[row] - low.along[opening]) - low.width[opening] / 2
    clear = np.ones(len(wall), bool)
    clear[row[gap < reach + DOOR_GAP]] = False
    return clear


def _boxes(polygons: NDArray[Any]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Middles, longer and shorter sides of the boxes around outlines, (n, 2) each; 0 for none."""
    boxes = shapely.oriented_envelope(polygons)
    good = (shapely.get_type_id(boxes) == 3) & ~shapely.is_empty(boxes)
    corner = np.zeros((len(polygons), 5, 2))
    corner[good] = shapely.get_coordinates(boxes[good]).reshape(-1, 5, 2)
    a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 1]
    longer = (np.hypot(*a.T) >= np.hypot(*b.T))[:, None]
    axis, across = np.where(longer, a, b), np.where(longer, b, a)
    flip = (axis[:, 0] < -1e-9) | ((np.abs(axis[:, 0]) <= 1e-9) & (axis[:, 1] < 0))
    axis[flip] *= -1
    return (corner[:, 0] + corner[:, 2]) / 2, axis, across


def _on_plan(placing: Placing, site: Site, seed: int, each: Fixture, part: IntArray) -> None:
    """Stand things on the middle of roofs, or in rows on the ground of plans."""
    found, volumes = site.found, site.found.volumes
    part = part[volumes.usable[part]]
    middle, axis, across = (column[part] for column in site.boxes)
    good = np.hypot(*axis.T) > 1e-6
    part, middle, axis, across = part[good], middle[good], axis[good], across[good]
    if not len(part):
        return
    length = np.hypot(*axis.T)
    unit = axis / np.maximum(length, 1e-9)[:, None]
    count = np.ones(len(part), np.int64)
    if each.spacing:
        count = np.maximum(1, np.floor(length / each.spacing)).astype(np.int64)
    elif each.at == "top" and not each.stretch:  # where roofs that rise to a point have it
        middle = shapely.get_coordinates(shapely.centroid(volumes.polygons[part]))
    row = np.repeat(np.arange(len(part)), count)
    number = numbered(count)
    step = (number + 0.5) / count[row] - 0.5
    at = middle[row] + axis[row] * step[:, None]
    z = volumes.top[part[row]] if each.at == "top" else volumes.ground[part[row]]
    yaw = np.arctan2(unit[row, 1], unit[row, 0])
    size = np.ones((len(row), 3))
    if each.stretch == "plan":
        size[:, 0], size[:, 1] = length[row], np.hypot(*across.T)[row]
    elif each.stretch == "across":
        size[:, 1] = np.hypot(*across.T)[row]
    elif each.stretch == "along":
        size[:, 0] = length[row]
    index = part_index(found, part[row], number)
    made = fixture(each.name, detail=placing.detail)
    building = volumes.building[part[row]]
    placing.put(
        made, hash_ids(0, each.name, building, index), building,
        np.column_stack([at, z + each.lift]),
        np.column_stack([np.zeros((len(row), 2)), yaw]),
        scale=size, tint=_tint(found, seed, each, part[row]),
    )  # fmt: skip


def part_index(found: Facade, part: IntArray, number: IntArray) -> NDArray[np.uint64]:
    """Key of a thing on a part that does not depend on the order of parts, (k,)."""
    middle = np.rint(
        shapely.get_coordinates(shapely.centroid(found.volumes.polygons[part])) * 100
    ).astype(np.int64)
    level = np.rint(found.volumes.top[part] * 100).astype(np.int64)
    key = middle[:, 0] * 7919 + middle[:, 1] * 104729 + level * 1299709 + number
    return np.asarray(key.view(np.uint64))
