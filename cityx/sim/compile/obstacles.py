"""Obstacles of a world: everything solid that somebody on a street could hit, as segments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.colliders import collider_of
from cityx.city.city import City
from cityx.city.scene import Instances, Prototype
from cityx.city.thing_outlines import placed_rings
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.convex import Box, Cylinder, Solid
from cityx.sim.blocks import Blocks
from cityx.sim.compile.lanes import Pieces
from cityx.sim.compile.rasters import clearance_to
from cityx.sim.kernels import cuts, rasters

FOOT, HEAD = 0.1, 4.5  # metres above a surface between which a thing is in somebody's way
CELL = 8.0  # metres of a cell of segments
AREA = 16.0  # metres of the cells by which the highest and lowest way near a place is known
# Layers of meshes that are no obstacle: what one moves on, what hangs, what is far away.
NOT_SOLID = ("ground", "surroundings", "shores", "courts", "wires", "power_lines", "garden_paths",
             "lawn_edging")  # fmt: skip
# Kinds of things that lie in a wall or on a roof, or go with a car; their walls stand for them.
IN_WALLS = ("window", "roof_furniture", "street_cover", "vehicle_part")
ON_WALLS = ("trim", "shopfront", "door")  # count where they stand at a roadway
NEAR_ROADWAY = 1.5  # metres
CORNERS = 8  # of a cylinder
GRAIN = 0.01  # metres within which segments are one


@dataclass(frozen=True)
class Obstacles:
    """s segments, each solid between two heights.

    Attributes
    ----------
    segment
        (s, 6) float32: both ends in plan, lowest and highest metre.
    object_id
        (s,) uint64.
    grid
        (5,) west, south, metres of a cell, columns and rows.
    cell_start, cell_segment
        (cells + 1,) and (k,) int32, segments by cell, row by row from the south-west.
    """

    segment: NDArray[np.float32]
    object_id: NDArray[np.uint64]
    grid: FloatArray
    cell_start: NDArray[np.int32]
    cell_segment: NDArray[np.int32]


def obstacles_of(
    city: City, pieces: Pieces, flags: Blocks, frame: FloatArray, roadway: int
) -> Obstacles:
    """Cut everything solid between ankle and the roof of a lorry.

    Parameters
    ----------
    city
        With its scene.
    pieces
        Where one drives, which counts as a surface too.
    flags, frame
        The raster of surfaces, and where it lies.
    roadway
        Bits of the raster that are driven on.
    """
    heights = _Surfaces(city, pieces, frame)
    apart = clearance_to(frame, flags, roadway)
    parts = [_of_meshes(city, heights)]
    for rows in city.scene.instances.values():
        parts += _of_instances(city.scene.prototypes, rows, heights, apart, frame)
    segment = np.concatenate([np.zeros((0, 6)), *(each for each, _ in parts)])
    owner = np.concatenate([np.zeros(0, np.uint64), *(ids for _, ids in parts)])
    segment, owner = _merged(segment, owner)
    west, south, east, north = city.layout.extent
    grid = np.array([west, south, CELL, max(np.ceil((east - west) / CELL), 1),
                     max(np.ceil((north - south) / CELL), 1)])  # fmt: skip
    short = segment.astype(np.float32)
    start, row = rasters.grid_cells(short, grid)
    return Obstacles(short, owner, grid, start, row)


class _Surfaces:
    """Heights of what is stood and driven on, by place; a class for what is prepared."""

    def __init__(self, city: City, pieces: Pieces, frame: FloatArray) -> None:
        self._terrain = city.terrain
        self._west, self._south = float(frame[0]), float(frame[1])
        width, height = (max(int(np.ceil(frame[k] * frame[2] / AREA)), 1) + 2 for k in (3, 4))
        self._low = np.full((height, width), np.inf)
        self._high = np.full((height, width), -np.inf)
        row, column = self._cell(pieces.point[:, :2])
        for j in (-1, 0, 1):
            for i in (-1, 0, 1):
                at = (np.clip(row + j, 0, height - 1), np.clip(column + i, 0, width - 1))
                np.minimum.at(self._low, at, pieces.point[:, 2])
                np.maximum.at(self._high, at, pieces.point[:, 2])

    def _cell(self, xy: FloatArray) -> tuple[IntArray, IntArray]:
        height, width = self._low.shape
        column = np.clip((xy[:, 0] - self._west) // AREA + 1, 0, width - 1).astype(np.int64)
        row = np.clip((xy[:, 1] - self._south) // AREA + 1, 0, height - 1).astype(np.int64)
        return row, column

    def band(self, xy: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(n,) lowest and highest metre at which something at (n, 2) places is in the way."""
        ground = self._terrain.height_at(xy)
        cell = self._cell(xy)
        low = np.minimum(ground, self._low[cell]) + FOOT
        return low, np.maximum(ground, self._high[cell]) + HEAD


def _of_meshes(city: City, heights: _Surfaces) -> tuple[FloatArray, NDArray[np.uint64]]:
    found, owners = [np.zeros((0, 6))], [np.zeros(0, np.uint64)]
    for layer, batch in city.scene.meshes.items():
        if layer in NOT_SOLID or not len(batch.faces):
            continue
        vertices = np.asarray(batch.vertices)
        corner = np.where(batch.faces < 0, batch.faces[:, :1], batch.faces)
        low, high = heights.band(vertices[corner[:, 0], :2])
        z = vertices[:, 2][corner]  # (f, 4)
        near = np.flatnonzero((z.min(axis=1) < high) & (z.max(axis=1) > low))
        segment, face = cuts.side_segments(
            vertices, np.asarray(batch.faces[near]), low[near], high[near]
        )
        found.append(segment)
        owners.append(batch.object_id[batch.face_object()[near[face]]])
    return np.concatenate(found), np.concatenate(owners)


def _of_instances(
    prototypes: tuple[Prototype, ...], rows: Instances, heights: _Surfaces,
    apart: Blocks, frame: FloatArray,
) -> list[tuple[FloatArray, NDArray[np.uint64]]]:  # fmt: skip
    found: list[tuple[FloatArray, NDArray[np.uint64]]] = []
    if not rows.count:
        return found
    low, high = heights.band(np.asarray(rows.position[:, :2]))
    away = _at(apart, frame, np.asarray(rows.position[:, :2])) / 10.0
    for number in np.unique(rows.prototype).tolist():
        one = prototypes[number]
        if one.kind in IN_WALLS or not len(one.mesh.faces):
            continue
        z = one.mesh.vertices[:, 2]
        of = rows.prototype == number
        scale, at = np.asarray(rows.scale[of], float), np.asarray(rows.position[of])
        near = z.min() * scale[:, 2] + at[:, 2] < high[of]
        near &= z.max() * scale[:, 2] + at[:, 2] > low[of]
        if one.kind in ON_WALLS:
            near &= away[of] < NEAR_ROADWAY
        if not near.any():
            continue
        of = np.flatnonzero(of)[near]
        for solid in _solids(one):
            found.append(_placed(solid, rows, of, low, high))
    return found


def _solids(prototype: Prototype) -> list[Solid]:
    """Return what of a thing is solid: of a tree with a stem the stem."""
    solids = collider_of(prototype)
    if prototype.kind == "tree" and isinstance(solids[0], Cylinder):
        return solids[:1]
    return solids


def _at(raster: Blocks, frame: FloatArray, xy: FloatArray) -> NDArray[np.float64]:
    column = np.clip((xy[:, 0] - frame[0]) // frame[2], 0, frame[3] - 1).astype(np.int64)
    row = np.clip((xy[:, 1] - frame[1]) // frame[2], 0, frame[4] - 1).astype(np.int64)
    return np.asarray(raster.at(row, column), float)


def _placed(
    solid: Solid, rows: Instances, of: IntArray, low: FloatArray, high: FloatArray
) -> tuple[FloatArray, NDArray[np.uint64]]:
    """Return the sides of one solid of a prototype wherever it stands in somebody's way."""
    ring, foot, head = _outline(solid)
    scale, at = np.asarray(rows.scale[of], float), np.asarray(rows.position[of])
    foot, head = foot * scale[:, 2] + at[:, 2], head * scale[:, 2] + at[:, 2]
    near: BoolArray = (foot < high[of]) & (head > low[of])
    corners = placed_rings(ring, at[near, :2], rows.rotation[of[near], 2], scale[near])
    count = len(ring)
    ends = np.concatenate([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 4)
    span = np.repeat(np.column_stack([foot, head])[near], count, axis=0)
    return np.column_stack([ends, span]), np.repeat(rows.object_id[of[near]], count)


def _outline(solid: Solid) -> tuple[FloatArray, float, float]:
    """(k, 2) outline in plan, lowest and highest metre of a solid in its own frame."""
    if isinstance(solid, Cylinder):
        turn = np.arange(CORNERS) * (2 * np.pi / CORNERS)
        ring = solid.radius * np.column_stack([np.cos(turn), np.sin(turn)]) + solid.center[:2]
        z = float(solid.center[2])
        return ring, z - solid.half_height, z + solid.half_height
    corners = solid.corners() if isinstance(solid, Box) else solid.points
    hull = shapely.convex_hull(shapely.multipoints(corners[:, :2]))
    ring = shapely.get_coordinates(hull)
    return ring[: max(len(ring) - 1, 1)], float(corners[:, 2].min()), float(corners[:, 2].max())


def _merged(
    segment: FloatArray, owner: NDArray[np.uint64]
) -> tuple[FloatArray, NDArray[np.uint64]]:
    """Put segments of one object in one place above each other together, in a fixed order."""
    ends = np.rint(segment[:, :4] / GRAIN).astype(np.int64)
    swap = (ends[:, 0] > ends[:, 2]) | ((ends[:, 0] == ends[:, 2]) & (ends[:, 1] > ends[:, 3]))
    ends[swap] = ends[swap][:, [2, 3, 0, 1]]
    order = np.lexsort((segment[:, 4], owner, *ends.T[::-1]))
    ends, own, span = ends[order], owner[order], segment[order, 4:]
    if not len(own):
        return segment, owner
    same = (ends[1:] == ends[:-1]).all(axis=1) & (own[1:] == own[:-1])
    group = np.concatenate([[0], np.cumsum(~same)])
    # Highest so far within a group; where the next one begins above it there is a gap.
    shift = group * 1e5
    top = np.maximum.accumulate(span[:, 1] + shift)
    fresh = np.r_[True, ~same | (span[1:, 0] + shift[1:] > top[:-1] + GRAIN)]
    first = np.flatnonzero(fresh)
    high = np.maximum.reduceat(span[:, 1], first)
    return np.column_stack([ends[first] * GRAIN, span[first, 0], high]), own[first]
