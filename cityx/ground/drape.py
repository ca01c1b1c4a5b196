"""Draping: the faces of the ground become a mesh on the terrain, with kerbs and quays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import DROPPED, KERB_HEIGHT, LABEL, SURFACES, UNDRAPED, Ground
from cityx.city.mesh import NO_VERTEX, MeshBatch, concatenate, one_mesh
from cityx.city.terrain import Terrain
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ground.arrangement import BEYOND
from cityx.ids import stable_id, uniform

LOWERED = ("kerb_dropped", "tactile", "tactile_pale", "tactile_buff", "tactile_red", "landing")
RAMPS = ("ramp", "guide_strip")  # rise from what is lowered to the walk
STEP = 0.001  # metres; lower steps between surfaces get no vertical face
TINT_RANGE = 0.10  # of the brightness of neighbouring pieces of one material
FLAT_WATER = 2.0  # metres of relief along the shore above which water is a sloping river
SHORE_QUANTILE = 10.0  # percent; most of the shore stands above the water
HEAD = 0.002  # metres; what a ramp lacks to the walk that rounding to the grid explains
RAMP_SLOPE = 12.0  # metres of ramp per metre of rise (ADA 2010, 405.2)


@dataclass(frozen=True)
class Paving:
    """How the f faces of a ground are paved.

    Attributes
    ----------
    along
        (f, 2) float, unit vectors along which the pattern of each face is laid.
    shift
        (f,) float, metres that are added to places across it: patterns with bands begin there.
    material
        (f,) int, row of `materials`, -1 for what the face's surface is made of.
    materials
        Names of materials.
    """

    along: FloatArray
    shift: FloatArray
    material: IntArray
    materials: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Levels:
    """Heights of faces: each face lies on one level, each level has a height at every vertex."""

    of_face: IntArray  # (f,)
    label: IntArray  # (l,) label of each level
    height: FloatArray  # (l,) metres above the terrain, or above zero
    flat: NDArray[np.bool_]  # (l,) whether the height is absolute
    ramp: FloatArray  # (n,) metres above the terrain of ramps at every vertex

    def z(self, level: IntArray, vertex: IntArray, terrain: FloatArray) -> FloatArray:
        ramps = np.isin(self.label[level], [LABEL[name] for name in RAMPS])
        above = np.where(ramps, self.ramp[vertex], self.height[level])
        return np.asarray(np.where(self.flat[level], 0.0, terrain[vertex]) + above)


def ramp_heights(ground: Ground) -> FloatArray:
    """(n,) height of ramps above the terrain: up to the walk, away from what lies dropped."""
    rise = np.full(len(ground.vertices), KERB_HEIGHT)
    label = ground.face_label
    left, right = ground.edge_faces.T.astype(np.int64)
    low = np.isin(label, [LABEL[name] for name in LOWERED])
    ramp = ground.labelled(*RAMPS)
    beside = np.maximum(right, 0)
    foot = (right != BEYOND) & ((ramp[left] & low[beside]) | (low[left] & ramp[beside]))
    used = np.unique(ground.triangles[ramp[ground.triangle_face]])
    if foot.any() and len(used):
        feet = shapely.linestrings(ground.vertices[ground.edges[foot]])
        spots = shapely.points(ground.vertices[used])
        row, edge = shapely.STRtree(feet).query_nearest(spots, all_matches=False)
        distance = shapely.distance(spots[row], feet[edge])
        climbed = DROPPED + distance / RAMP_SLOPE
        # Its foot may lie a step of the grid off; its head meets the walk all the same.
        rise[used[row]] = np.where(climbed > KERB_HEIGHT - HEAD, KERB_HEIGHT, climbed)
    return np.asarray(np.round(rise, 4))


def _levels(ground: Ground, terrain: FloatArray, flush: bool) -> _Levels:
    """One level per label, and one per body of water where the terrain is not flat."""
    labels = np.arange(len(SURFACES))
    offsets = np.array([surface.offset for surface in SURFACES])
    if flush:
        offsets[labels != LABEL["water"]] = KERB_HEIGHT
    of_face = ground.face_label.astype(np.int64)
    flat = np.zeros(len(labels), bool)
    ramp = ramp_heights(ground)
    if not len(terrain) or np.ptp(terrain) == 0.0:
        return _Levels(of_face, labels, offsets, flat, ramp)
    wet = np.flatnonzero(ground.face_label == LABEL["water"])
    bodies, body = np.unique(ground.face_object[wet], return_inverse=True)
    number = np.full(len(of_face), -1)
    number[wet] = body
    of_triangle = number[ground.triangle_face]
    rows = np.flatnonzero(of_triangle >= 0)
    owner = np.repeat(of_triangle[rows], 3)
    heights = terrain[ground.triangles[rows].ravel()]
    order = np.lexsort((heights, owner))
    owner, heights = owner[order], heights[order]
    begin = np.searchsorted(owner, np.arange(len(bodies)))
    end = np.searchsorted(owner, np.arange(len(bodies)), side="right")
    level = np.array(
        [np.percentile(heights[a:b], SHORE_QUANTILE) if b > a else 0.0
         for a, b in zip(begin, end, strict=True)]
    )  # fmt: skip
    relief = np.array(
        [heights[b - 1] - heights[a] if b > a else 0.0 for a, b in zip(begin, end, strict=True)]
    )
    still = np.flatnonzero(relief < FLAT_WATER)
    renamed = np.full(len(bodies), LABEL["water"])
    renamed[still] = len(labels) + np.arange(len(still))
    of_face = of_face.copy()
    of_face[wet] = renamed[body]
    water = SURFACES[LABEL["water"]].offset
    return _Levels(
        of_face,
        np.concatenate([labels, np.full(len(still), LABEL["water"])]),
        np.concatenate([offsets, np.round(level[still] + water, 4)]),
        np.concatenate([flat, np.ones(len(still), bool)]),
        ramp,
    )


def drape(
    ground: Ground,
    terrain: Terrain,
    seed: int = 0,
    *,
    flush: bool = False,
    base: FloatArray | None = None,
    layer: str = "ground",
    paving: Paving | None = None,
) -> MeshBatch:
    """Raise the faces onto the terrain: one object per surface, with its vertical edges.

    Parameters
    ----------
    ground
        The arrangement. Faces under buildings are left out; their walls go into the soil. So are
        openings, which other surfaces fill.
    terrain
        Heights; each surface lies its offset above them. A body of water is level.
    seed
        Of the slight variation in brightness from piece to piece.
    flush
        Lay all land on one level, without kerbs and other small steps.
    base
        (n,) heights of the vertices in place of the terrain's, metres.
    layer
        What the surfaces belong to, for their ids.
    paving
        How the faces are paved; as their surfaces say, along the east, when None.

    Returns
    -------
    mesh
        Objects in the order of `SURFACES`, ids ``stable_id(layer, name)``.
    """
    if base is None:
        base = np.round(terrain.height_at(ground.vertices), 4)
    levels = _levels(ground, base, flush)
    brightness = 1.0 + TINT_RANGE * (uniform(seed, "ground/tint", ground.face_object) - 0.5)
    brightness[ground.face_object == 0] = 1.0
    tops = _Tops(ground, levels, base, brightness, paving)
    sides = _Sides(ground, levels, base, brightness)
    laid = paving.materials if paving is not None else ()
    batches = []
    for label, surface in enumerate(SURFACES):
        if surface.name in UNDRAPED:
            continue
        parts = [part for part in (tops(label), sides(label)) if part is not None]
        if not parts:
            continue
        vertices, faces, material, uv, tint = _joined(parts)
        batches.append(
            one_mesh(
                stable_id(layer, surface.name), vertices, faces, material=material,
                materials=(surface.material, surface.edge_material, *laid), uv=uv, tint=tint,
            )
        )  # fmt: skip
    return concatenate(batches)


_Part = tuple[FloatArray, IntArray, NDArray[np.int16], FloatArray, FloatArray]


def _joined(parts: list[_Part]) -> _Part:
    shift = 0
    faces = []
    for part in parts:
        faces.append(np.where(part[1] == NO_VERTEX, NO_VERTEX, part[1] + shift))
        shift += len(part[0])
    return (
        np.concatenate([part[0] for part in parts]),
        np.concatenate(faces),
        np.concatenate([part[2] for part in parts]),
        np.concatenate([part[3] for part in parts]),
        np.concatenate([part[4] for part in parts]),
    )


class _Tops:
    """Top faces, label by label."""

    def __init__(
        self, ground: Ground, levels: _Levels, base: FloatArray, brightness: FloatArray,
        paving: Paving | None,
    ) -> None:  # fmt: skip
        self.paving = paving
        self.ground, self.levels, self.base, self.brightness = ground, levels, base, brightness
        label = ground.face_label[ground.triangle_face]
        self.order = np.argsort(label, kind="stable")
        self.start = np.searchsorted(label[self.order], np.arange(len(SURFACES) + 1))

    def __call__(self, label: int) -> _Part | None:
        rows = self.order[self.start[label] : self.start[label + 1]]
        if not len(rows):
            return None
        ground = self.ground
        corner = ground.triangles[rows].astype(np.int64)
        level = self.levels.of_face[ground.triangle_face[rows]]
        vertex, at, index = _numbered(level, corner, len(ground.vertices))
        z = self.levels.z(at, vertex, self.base)
        vertices = np.column_stack([ground.vertices[vertex], z])
        faces = np.column_stack([index, np.full(len(rows), NO_VERTEX)])
        uv = np.zeros((len(rows), 4, 2))
        uv[:, :3] = ground.vertices[corner]
        material = np.zeros(len(rows), np.int16)
        if self.paving is not None:
            face = ground.triangle_face[rows]
            uv[:, :3] = _turned(uv[:, :3], self.paving.along[face])
            uv[:, :3, 1] += self.paving.shift[face, None]
            chosen = self.paving.material[face]
            material = np.where(chosen >= 0, chosen + 2, 0).astype(np.int16)
        tint = np.repeat(self.brightness[ground.triangle_face[rows]][:, None], 3, axis=1)
        return vertices, faces, material, uv, tint


def _numbered(level: IntArray, corner: IntArray, count: int) -> tuple[IntArray, ...]:
    """Return the vertices of (t, 3) corners, `count` at most, on the levels of (t,) triangles.

    Returns
    -------
    vertex, level, index
        (v,) each once for each level, by level and number, and (t, 3) which of them corners are.
    """
    if (level == level[0]).all():  # marking them takes a tenth of the time of sorting them
        used = np.zeros(count, bool)
        used[corner] = True
        vertex = np.flatnonzero(used)
        number = np.cumsum(used) - 1
        return vertex, np.full(len(vertex), level[0]), number[corner]
    keys, index = np.unique(level[:, None] * count + corner, return_inverse=True)
    return keys % count, keys // count, index.reshape(-1, 3)


def _turned(places: FloatArray, along: FloatArray) -> FloatArray:
    """Places, (t, 3, 2), along unit vectors, (t, 2), and to the left of them."""
    x, y = places[..., 0], places[..., 1]
    c, s = along[:, :1], along[:, 1:]
    return np.asarray(np.round(np.stack([x * c + y * s, y * c - x * s], axis=2), 4))


class _Sides:
    """Vertical faces where a neighbour lies lower, by the label of the higher face."""

    def __init__(
        self, ground: Ground, levels: _Levels, base: FloatArray, brightness: FloatArray
    ) -> None:
        closed = [LABEL[name] for name in UNDRAPED]
        left, right = ground.edge_faces.T.astype(np.int64)
        inner = np.flatnonzero(right != BEYOND)
        left, right = left[inner], right[inner]
        a, b = ground.edges[inner].T.astype(np.int64)
        za = [levels.z(levels.of_face[side], a, base) for side in (left, right)]
        zb = [levels.z(levels.of_face[side], b, base) for side in (left, right)]
        rise = (za[0] + zb[0]) - (za[1] + zb[1])
        open_air = ~np.isin(ground.face_label[left], closed)
        open_air &= ~np.isin(ground.face_label[right], closed)
        step = np.flatnonzero((np.abs(rise) > 2 * STEP) & open_air)
        up = rise[step] > 0
        a, b = np.where(up, a[step], b[step]), np.where(up, b[step], a[step])
        lower = np.column_stack([np.where(up, za[1][step], zb[0][step]),
                                 np.where(up, zb[1][step], za[0][step])])  # fmt: skip
        upper = np.column_stack([np.where(up, za[0][step], zb[1][step]),
                                 np.where(up, zb[0][step], za[1][step])])  # fmt: skip
        face = np.where(up, left[step], right[step])
        pa, pb = ground.vertices[a], ground.vertices[b]
        low_a, low_b = np.column_stack([pa, lower[:, 0]]), np.column_stack([pb, lower[:, 1]])
        top_a, top_b = np.column_stack([pa, upper[:, 0]]), np.column_stack([pb, upper[:, 1]])
        self.vertices = np.stack([low_a, low_b, top_b, top_a], axis=1)
        length = np.hypot(*(pb - pa).T)
        zero = np.zeros(len(length))
        u = np.stack([zero, length, length, zero], axis=1)
        self.uv = np.stack([u, self.vertices[:, :, 2]], axis=2)
        self.tint = np.repeat(brightness[face][:, None], 3, axis=1)
        self.label = ground.face_label[face]

    def __call__(self, label: int) -> _Part | None:
        rows = np.flatnonzero(self.label == label)
        if not len(rows):
            return None
        faces = np.arange(4 * len(rows)).reshape(-1, 4)
        material = np.ones(len(rows), np.int16)
        return self.vertices[rows].reshape(-1, 3), faces, material, self.uv[rows], self.tint[rows]
