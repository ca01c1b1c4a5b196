"""Surroundings: the land beyond the site, joined to its border vertex by vertex."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.city.ground import LABEL, SURFACES, Ground
from cityx.city.mesh import NO_VERTEX, MeshBatch, empty_batch, one_mesh
from cityx.city.terrain import Terrain
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ground.arrangement import BEYOND, arrange, face_areas, regions
from cityx.ground.cells import relief_lines
from cityx.ids import stable_id

LEVEL_REACH = 1500.0  # metres of level land, so that views do not end in a void
FAR_TOLERANCE = 4.0  # metres by which the land beyond may miss its heights
LARGEST = 2000.0  # metres; the largest cell of the land beyond
SKIRT = 2.0  # metres the border reaches down
OPEN_LAND = (0.95, 0.95, 0.90)  # tint of the land beyond
TOWN_LAND = (0.55, 0.55, 0.53)  # the same where the site is a piece of a city
BUILT_ON = 0.2  # slope up to which the land round a city is built on
OPEN_LABELS = ("block", "farmland", "grass", "meadow", "wood", "park", "sand", "bare", "pitch")
TOWN, OPEN, SOIL = range(3)
OFFSET = SURFACES[LABEL["block"]].offset


def surroundings(
    ground: Ground, terrain: Terrain, around: Terrain | None = None
) -> tuple[MeshBatch, float]:
    """Lay land round the site, joined to its border vertex by vertex.

    Parameters
    ----------
    ground, terrain
        The site.
    around
        Heights of the site and the land round it; without them the land evens out, so that the
        horizon is a line.

    Returns
    -------
    mesh, tolerance
        One object, and the metres by which the corners of its cells miss the heights at most.
    """
    rim, height = _rim(ground, terrain)
    if not len(rim):
        return empty_batch(), 0.0
    if around is None:
        vertices, triangles, tolerance = *_level_land(rim, height), 0.0
    else:
        vertices, triangles, tolerance = _hills(rim, height, around)
    a, b = np.arange(len(rim)), np.roll(np.arange(len(rim)), -1)
    foot = len(vertices)
    skirt = np.column_stack([b, a, a + foot, b + foot])
    vertices = np.concatenate([vertices, np.column_stack([rim, height - SKIRT])])
    faces = np.concatenate([np.pad(triangles, ((0, 0), (0, 1)), constant_values=NO_VERTEX), skirt])
    land = np.where(_in_town(ground) & (_slopes(vertices, triangles) < BUILT_ON), TOWN, OPEN)
    material = np.concatenate([land, np.full(len(skirt), SOIL)])
    uv = np.zeros((len(faces), 4, 2))
    uv[faces != NO_VERTEX] = vertices[faces[faces != NO_VERTEX], :2]
    tint = np.array([TOWN_LAND, OPEN_LAND, OPEN_LAND])[material]
    mesh = one_mesh(
        stable_id("ground", "surroundings"), vertices, faces, material=material,
        materials=("concrete", "grass", "soil"), uv=uv, tint=tint,
    )  # fmt: skip
    return mesh, tolerance


def _rim(ground: Ground, terrain: Terrain) -> tuple[FloatArray, FloatArray]:
    """(k, 2) vertices on the site's border from its south-west corner on, (k,) their heights."""
    used = np.unique(ground.edges[ground.edge_faces[:, 1] == BEYOND])
    rim = ground.vertices[used]
    if len(rim):
        along = _way_round(rim, *_box(rim))
        along[np.isnan(along)] = np.inf  # a gap inside the site is no border
        rim = rim[np.argsort(along)[: np.isfinite(along).sum()]]
    return rim, np.round(terrain.height_at(rim) + OFFSET, 4)


def _box(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    return points.min(axis=0), points.max(axis=0)


def _way_round(points: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """(n,) metres along the border of a rectangle, counter-clockwise; NaN for points off it."""
    (x, y), (width, depth) = (points - low).T, high - low
    return np.select(
        [y == 0, x == width, y == depth, x == 0],
        [x, width + y, 2 * width + depth - x, 2 * (width + depth) - y],
        np.nan,
    )


def _level_land(rim: FloatArray, height: FloatArray) -> tuple[FloatArray, IntArray]:
    low, high = _box(rim)
    centre, half = (low + high) / 2, np.maximum((high - low) / 2, 0.01)
    outer = centre + (rim - centre) * (half + LEVEL_REACH) / half
    even = np.full(len(rim), np.round(height.mean(), 4))
    vertices = np.concatenate([np.column_stack([rim, height]), np.column_stack([outer, even])])
    a, b = np.arange(len(rim)), np.roll(np.arange(len(rim)), -1)
    far = len(rim)
    triangles = [np.column_stack([a, a + far, b]), np.column_stack([b, a + far, b + far])]
    return vertices, np.concatenate(triangles)


def _hills(
    rim: FloatArray, height: FloatArray, around: Terrain
) -> tuple[FloatArray, IntArray, float]:
    """Mesh the land round the site; its vertices on the border come first, as they are."""
    low, high = _box(rim)
    west, south = around.origin
    rows, columns = around.heights.shape
    wide = (west, south, west + around.cell * (columns - 1), south + around.cell * (rows - 1))
    lines, tolerance = relief_lines(wide, around, LARGEST, FAR_TOLERANCE)
    site = regions([shapely.Polygon(rim)], LABEL["void"], 1)
    land = arrange(site, wide, lines=lines)
    triangles = land.triangles_of("block").astype(np.int64)
    used, triangles = np.unique(triangles, return_inverse=True)
    place = land.vertices[used]
    along = _way_round(place, low, high)
    inner = ((place >= low) & (place <= high)).all(axis=1)
    z = np.round(around.height_at(place) + OFFSET, 4)
    # Cells that end at the border meet it between its vertices, on the straight line.
    known = _way_round(rim, low, high)
    z[inner] = np.interp(along[inner], known, height, period=2 * (high - low).sum())
    vertices = np.concatenate([np.column_stack([rim, height]), np.column_stack([place, z])])
    return vertices, triangles.reshape(-1, 3) + len(rim), tolerance


def _slopes(vertices: FloatArray, triangles: IntArray) -> FloatArray:
    """(t,) rise over run of triangles."""
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    return np.asarray(np.hypot(normal[:, 0], normal[:, 1]) / np.maximum(np.abs(normal[:, 2]), 1e-9))


def _in_town(ground: Ground) -> bool:
    """Whether most of the site's land is paved, so that the land beyond it is a city too."""
    by_label = np.bincount(ground.face_label, face_areas(ground), minlength=len(SURFACES))
    open_land = by_label[[LABEL[name] for name in OPEN_LABELS]].sum()
    return bool(by_label.sum() - by_label[LABEL["water"]] > 2 * open_land)
