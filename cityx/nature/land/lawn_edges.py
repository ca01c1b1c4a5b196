"""Stone edging where lawns and beds of yards and courts end at paving."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, MeshBatch
from cityx.city.ground import Ground
from cityx.city.mesh import one_mesh
from cityx.geometry.arrays import FloatArray
from cityx.ground.arrangement import BEYOND
from cityx.ground.pieces import heights
from cityx.ids import stable_id

LAYER = "lawn_edging"
SOFT = ("grass", "bare")
HARD = ("courtyard", "frontage", "gravel", "parking", "sidewalk", "edging")
BROAD, HIGH, DEEP = 0.10, 0.06, 0.05  # metres: breadth, height over the paving and foot below it
INSIDE = 0.05  # share of an edge from its ends at which the paving's height is taken
LEAST = 0.3  # metres; edges that are shorter have none


def edging_lines(ground: Ground) -> FloatArray:
    """(n, 2, 2) edges of the ground at which lawns meet paving, the lawn on their left."""
    left, right = ground.edge_faces.T.astype(np.int64)
    soft, hard = ground.labelled(*SOFT), ground.labelled(*HARD)
    # What the map describes has the edges that the map shows.
    soft, hard = soft & (ground.face_object == 0), hard & (ground.face_object == 0)
    other = np.maximum(right, 0)
    inner = right != BEYOND
    here, back = inner & soft[left] & hard[other], inner & hard[left] & soft[other]
    ends = ground.vertices[ground.edges[here | back]]
    ends[back[here | back]] = ends[back[here | back], ::-1]
    return np.asarray(ends[np.hypot(*(ends[:, 1] - ends[:, 0]).T) > LEAST])


def _open_at(ends: FloatArray, ways: NDArray[Any]) -> FloatArray:
    """Cut segments, (n, 2, 2), where polygons lie on them."""
    if not len(ends) or not len(ways):
        return ends
    lines = shapely.linestrings(ends)
    line, way = shapely.STRtree(ways).query(lines, predicate="intersects")
    over = np.unique(line)
    start = np.searchsorted(line, over)
    taken = [shapely.union_all(ways[group]) for group in np.split(way, start[1:])]
    left = shapely.get_parts(shapely.difference(lines[over], np.array(taken, object)))
    left = left[shapely.length(left) > LEAST]
    parts = shapely.get_coordinates(left).reshape(-1, 2, 2)
    return np.concatenate([np.delete(ends, over, axis=0), parts])


def lawn_edges(city: City, ways: NDArray[Any]) -> MeshBatch | None:
    """Set stones along the edges of lawns, on the side of the lawn; None where there are none.

    Parameters
    ----------
    city
        City with its ground.
    ways
        Polygons of paths, where no stone lies across.
    """
    if city.ground is None:
        return None
    ends = _open_at(edging_lines(city.ground), ways)
    if not len(ends):
        return None
    way = ends[:, 1] - ends[:, 0]
    way /= np.hypot(*way.T)[:, None]
    inward = BROAD * np.column_stack([-way[:, 1], way[:, 0]])[:, None]
    plan = np.stack([ends, ends + inward], axis=1)  # (n, outer and inner, both ends, 2)
    # The paving's height, off the corners at which other ground begins.
    spots = ends + INSIDE * (ends[:, ::-1] - ends) - inward / 4
    z = heights(city, spots.reshape(-1, 2)).reshape(-1, 1, 2)
    z = np.broadcast_to(z, (len(ends), 2, 2))
    low, high = (np.concatenate([plan, (z + up)[..., None]], axis=3) for up in (-DEEP, HIGH))
    # Corners of a stone: outer low, outer high, inner high, inner low, at both ends.
    corner = np.stack([low[:, 0], high[:, 0], high[:, 1], low[:, 1]], axis=1)  # (n, 4, 2, 3)
    vertices = corner.reshape(-1, 3)
    quads = np.array([[2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2] for k in range(3)])
    faces = (8 * np.arange(len(ends))[:, None, None] + quads).reshape(-1, 4)
    long = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    uv = np.zeros((len(ends), 3, 4, 2))
    uv[:, :, 1:3, 0] = long[:, None, None]
    uv[:, :, 2:, 1] = BROAD
    return one_mesh(stable_id(LAYER), vertices, faces, materials=("kerb_stone",),
                    uv=uv.reshape(-1, 4, 2))  # fmt: skip
