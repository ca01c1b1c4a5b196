"""Niches: openings set back into the walls of the shells, at the finest level of detail."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.openings.frames import NICHE_DEPTH, rim_of
from cityx.assets.styles.materials import material_named
from cityx.building.assembly import TRIM_MATERIAL
from cityx.building.facade import grammar as facades
from cityx.building.facade.recess import BACK, HEAD, SILL, Niches, Recesses, cut_niches
from cityx.building.growth import Piece
from cityx.city.mesh import MeshBatch
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import uniform

if TYPE_CHECKING:
    from cityx.building.facade.facade_plan import Facade
    from cityx.building.facade.placing import Placing
    from cityx.city.city import City

# Metres that windows stand back, from and to, by the material of the wall.
DEPTHS = {
    "stone": (0.18, 0.25), "brick": (0.12, 0.22), "plaster": (0.14, 0.22), "concrete": (0.14, 0.24),
    "wood": (0.10, 0.13), "metal_panel": (0.10, 0.14), "glass_wall": (0.10, 0.12),
}  # fmt: skip
USUAL_DEPTH = (0.12, 0.18)
SHOP_DEPTH = 0.20  # metres that shopfronts take
ROOM_DEPTH = 1.25  # metres of a shopfront and the room that is seen through it
FINE_LOD = 3  # from here on openings are set back into the walls and drawn in full
FLAT_DEPTH = 0.06  # metres to which fine things are squeezed that have no niche
FLAT_GAP = 0.016  # metres between their backs and the wall
SHALLOW = 0.10  # metres; tried where a deeper niche would meet another or leave the house
SOLID = 0.04  # metres of house left behind a niche
MOST = 0.26  # metres; no niche but that of a shop is deeper
SHARED = 0.01  # square metres that parts may share where they touch
SLACK = 0.004  # metres; outlines that touch are not in each other's way


@dataclass(frozen=True)
class Setting:
    """How each of k openings sits in its wall.

    Attributes
    ----------
    depth
        (k,) metres of its niche, 0 for those that lie on the wall.
    kept, piece
        The faces of the shells that stay, (f,) bool, and what takes the place of the others; None
        where nothing is set back.
    """

    depth: FloatArray
    kept: NDArray[np.bool_] | None = None
    piece: Piece | None = None

    @property
    def recessed(self) -> NDArray[np.bool_]:
        """(k,) whether an opening has a niche."""
        return np.asarray(self.depth > 0)


def set_back(placing: Placing, found: Facade, names: NDArray[np.str_], city: City) -> Setting:
    """Work out the niches of openings in the shells.

    Parameters
    ----------
    placing
        Knows how the drawn faces leave the straight walls.
    found
        The openings.
    names
        (k,) name of the prototype in each, whose outline the niche takes.
    city
        City with shells.

    Returns
    -------
    setting
        How every opening sits, and what that does to the shells. Openings stay on the wall where no
        flat piece of wall holds them or where something else stands in the wall behind.
    """
    batch = city.scene.meshes["buildings"]
    table, walls = found.openings, found.walls
    part = walls.part[table.wall].astype(np.int64)
    wanted = _depths(found, placing, city.seed)
    depth = _room(placing, found, wanted)
    face = placing.faces.before(walls, table.wall, table.along)
    place = walls.start[table.wall] + placing.unit[table.wall] * table.along[:, None]
    place = place + walls.normal[table.wall] * face[:, None]
    half = table.width / 2
    reach = np.clip([table.along - half, table.along + half], 0.0, walls.length[table.wall])
    ends = [placing.faces.before(walls, table.wall, x) for x in reach]
    lean = np.arctan2(ends[0] - ends[1], np.maximum(reach[1] - reach[0], 0.05))
    c, s = np.cos(lean), np.sin(lean)
    normal = walls.normal[table.wall]
    normal = np.column_stack(
        [normal[:, 0] * c - normal[:, 1] * s, normal[:, 0] * s + normal[:, 1] * c]
    )
    start, rim = _rims(names, table.width, table.height)
    building = placing.building[table.wall]
    group = np.searchsorted(batch.object_id, building).clip(max=max(batch.count - 1, 0))
    known = batch.object_id[group] == building if batch.count else np.zeros(table.count, bool)
    asked = Niches(
        group.astype(np.int64), place, normal, table.low, np.where(known, depth, 0.0), start, rim
    )
    trim = batch.materials.index(TRIM_MATERIAL) if TRIM_MATERIAL in batch.materials else -1
    made = cut_niches(
        batch.vertices, batch.faces, batch.face_object(), batch.material != trim,
        _looks(batch), batch.uv, asked,
    )  # fmt: skip
    depth = np.where(made.done, asked.depth, 0.0)
    tint = np.asarray(found.finishes.trim_tint, np.float32).reshape(-1, 3)[part]
    return Setting(depth, made.kept, niche_piece(batch, made, tint))


def fitted(
    placing: Placing, depth: FloatArray, width: FloatArray, height: FloatArray, size: FloatArray
) -> dict[str, Any]:
    """Scale and offset of things in openings, drawn for `size`, (k, 2), and, if fine, a niche."""
    if placing.detail < FINE_LOD:
        return {"scale": (width / size[:, 0], 1.0, height / size[:, 1])}
    # What has no niche is squeezed flat and stands before the wall.
    deep = np.where(depth > 0, depth, FLAT_DEPTH) / NICHE_DEPTH
    return {
        "scale": (width / size[:, 0], deep, height / size[:, 1]),
        "out": np.where(depth > 0, 0.0, FLAT_DEPTH + FLAT_GAP),
    }


def _depths(found: Facade, placing: Placing, seed: int) -> FloatArray:
    """Metres each opening is to be set back, one number per building and kind of wall."""
    table = found.openings
    part = found.walls.part[table.wall]
    material = np.asarray(found.finishes.wall_material, dtype=str)
    names, index = np.unique(material, return_inverse=True)
    span = np.array(
        [DEPTHS.get(material_named(name).root, USUAL_DEPTH) for name in names.tolist()]
    ).reshape(-1, 2)
    low, high = span[index][part].T if len(part) else np.zeros((2, 0))
    drawn = uniform(seed, "facade/recess", placing.building[table.wall])
    depth = low + (high - low) * drawn
    return np.where(table.role == facades.SHOP, ROOM_DEPTH, depth)


def _room(placing: Placing, found: Facade, wanted: FloatArray) -> FloatArray:
    """Metres by which each opening can be set back: as wanted, a shop's own, `SHALLOW` or 0."""
    table, walls, volumes = found.openings, found.walls, found.volumes
    part = walls.part[table.wall].astype(np.int64)
    depth = wanted.copy()
    solid = np.where(volumes.walls, volumes.polygons, shapely.Polygon())
    shapely.prepare(solid)
    # Far from every other wall of its part a niche meets nothing; the others are looked at again.
    every = np.arange(table.count)
    # Beside the rooms of shops there may be less.
    shops = table.role == facades.SHOP
    sill = np.full(len(solid), -np.inf)
    np.maximum.at(sill, part[shops], (table.low + table.height)[shops])
    most = np.where(table.low < sill[part], ROOM_DEPTH + SOLID, MOST)
    boxes = _footprints(placing, found, every, depth + most, wider=most)
    close = np.flatnonzero(~shapely.contains_properly(solid[part], boxes))
    # What is held, or meets nothing, does so too when others are made shallower.
    failing = close
    for attempt in (SHOP_DEPTH, SHALLOW, 0.0):
        boxes = _footprints(placing, found, failing, depth[failing] + SOLID)
        failing = failing[~shapely.contains_properly(solid[part[failing]], boxes)]
        depth[failing] = np.minimum(depth[failing], attempt)
    meeting = close
    for attempt in (SHOP_DEPTH, SHALLOW, 0.0):
        meeting = meeting[depth[meeting] > 0]
        if not len(meeting):
            break
        first, second = _meetings(placing, found, meeting, depth)
        later = np.concatenate([first, second]) if attempt else np.maximum(first, second)
        depth[later] = np.minimum(depth[later], attempt)
        meeting = np.unique(np.concatenate([first, second]))
    # Other parts that reach into this one would stand in the niche.
    crossed = _crossed(solid)[part]
    rows = np.flatnonzero(crossed & (depth > 0))
    boxes = _footprints(placing, found, rows, depth[rows])
    opening, other = shapely.STRtree(solid).query(boxes, predicate="intersects")
    opening = rows[opening]
    beside = part[opening] != other
    opening, other = opening[beside], other[beside]
    high = table.low + table.height
    through = volumes.low[other] < high[opening]
    through &= volumes.top[other] > table.low[opening]
    depth[opening[through]] = 0.0
    return depth


def _crossed(polygons: NDArray[np.object_]) -> NDArray[np.bool_]:
    """(n,) whether another polygon shares ground with each."""
    first, second = shapely.STRtree(polygons).query(polygons, predicate="intersects")
    pair = first < second
    first, second = first[pair], second[pair]
    shared = shapely.area(shapely.intersection(polygons[first], polygons[second])) > SHARED
    found = np.zeros(len(polygons), bool)
    found[first[shared]] = found[second[shared]] = True
    return found


def _footprints(
    placing: Placing, found: Facade, rows: IntArray, depth: FloatArray, *,
    wider: FloatArray | float = SLACK,
) -> NDArray[np.object_]:  # fmt: skip
    """Rectangles in plan, (k,), that the openings `rows` take when set back by `depth`, (k,)."""
    table, walls = found.openings, found.walls
    wall, along = table.wall[rows], table.along[rows]
    unit, normal = placing.unit[wall], walls.normal[wall]
    half = table.width[rows] / 2 + wider
    start = walls.start[wall]
    corners: list[FloatArray] = []
    for side in (-half, half):
        face = placing.faces.before(walls, wall, along + side)
        foot = start + unit * (along + side)[:, None]
        pair = [foot + normal * (face - SLACK)[:, None], foot + normal * (face - depth)[:, None]]
        corners += pair if not corners else pair[::-1]
    return np.asarray(shapely.polygons(np.stack(corners, axis=1)))


def _meetings(
    placing: Placing, found: Facade, rows: IntArray, depth: FloatArray
) -> tuple[IntArray, IntArray]:
    """Pairs of the openings `rows` whose niches would meet inside a house."""
    table = found.openings
    boxes = _footprints(placing, found, rows, depth[rows] + SLACK)
    first, second = shapely.STRtree(boxes).query(boxes, predicate="intersects")
    pair = first < second
    first, second = rows[first[pair]], rows[second[pair]]
    high = table.low + table.height + SLACK
    meet = (table.low[first] < high[second]) & (table.low[second] < high[first])
    return first[meet], second[meet]


def _rims(
    names: NDArray[np.str_], width: FloatArray, height: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Outlines of openings by the name of what fills them: offsets and points."""
    known, index = np.unique(names, return_inverse=True)
    shapes = [rim_of(str(name)) for name in known.tolist()]  # shares of width and height
    sizes = np.array([len(shape) for shape in shapes], np.int64)
    start = np.concatenate([[0], np.cumsum(sizes[index])]).astype(np.int64)
    owner = np.repeat(np.arange(len(names)), sizes[index])
    first = np.concatenate([[0], np.cumsum(sizes)])
    place = first[index][owner] + np.arange(start[-1]) - start[:-1][owner]
    points = np.concatenate(shapes) if shapes else np.zeros((0, 2))
    return start, points[place] * np.column_stack([width, height])[owner]


def _looks(batch: MeshBatch) -> IntArray:
    """(f,) a number for material and tint: equal for faces that look alike."""
    bits = np.ascontiguousarray(batch.tint, np.float32).view(np.uint32).astype(np.uint64)
    with np.errstate(over="ignore"):
        mixed = bits[:, 0] * np.uint64(0x9E3779B97F4A7C15)
        mixed ^= bits[:, 1] * np.uint64(0xBF58476D1CE4E5B9)
        mixed ^= bits[:, 2] * np.uint64(0xD6E8FEB86659FD93)
        mixed += batch.material.astype(np.uint64)
    return mixed.view(np.int64)


def niche_piece(batch: MeshBatch, made: Recesses, trim_tint: NDArray[np.float32]) -> Piece:
    """Faces of recesses: sides are made of the wall, sills and heads of the trim.

    Parameters
    ----------
    batch
        The shells that are cut.
    made
        The cut.
    trim_tint
        (k, 3) linear RGB of sills and heads of each niche.
    """
    names = batch.materials
    if TRIM_MATERIAL not in names:
        names = (*names, TRIM_MATERIAL)
    material = batch.material[made.source]
    tint = batch.tint[made.source]
    level = np.flatnonzero((made.kind == SILL) | (made.kind == HEAD))
    material[level] = names.index(TRIM_MATERIAL)
    tint[level] = trim_tint[made.niche[level]]
    tint[made.kind == BACK] *= 0.5  # in the shade of the pane before it
    owner = batch.face_object()
    return Piece(
        made.vertices, owner[made.vertex_source], made.faces, owner[made.source],
        material, names, made.uv, tint,
    )  # fmt: skip
