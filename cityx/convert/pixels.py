"""Pixels within faces: faces joined from the cells of a map are recognised by their stairs."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.errors import InputError
from cityx.geometry.raster.grid import Grid
from cityx.protocol.values import Surfaces
from cityx.sources.class_map import ClassMap
from cityx.sources.map_classes import MapClass, class_of

STAIRS = 0.25  # share of edges that are one cell long, from which borders are stairs
MANY = 8  # corners; a face that somebody drew in right angles seldom has more
EXACT = 1e-3  # cells; an edge that strays more from whole cells was drawn
MOST_PIXELS = 64_000_000


def pixels_of(surfaces: Surfaces) -> ClassMap | None:
    """Return the map whose cells were joined to faces, or None for faces that were drawn.

    Faces that carry a height or belong to an object were drawn.

    Parameters
    ----------
    surfaces
        Faces with the classes of a map; words of no class are unknown.
    """
    if surfaces.count == 0 or surfaces.object_id.any() or not np.isnan(surfaces.height).all():
        return None
    cell = _cell(surfaces.geometry)
    if cell is None:
        return None
    xmin, ymin, xmax, ymax = shapely.total_bounds(surfaces.geometry).tolist()
    rows, columns = round((ymax - ymin) / cell), round((xmax - xmin) / cell)
    if rows * columns > MOST_PIXELS:
        return None
    from rasterio.features import rasterize
    from rasterio.transform import Affine

    words, label = np.unique(surfaces.kind, return_inverse=True)
    labels = rasterize(
        zip(surfaces.geometry, label.tolist(), strict=True), (rows, columns), fill=len(words),
        transform=Affine(cell, 0.0, xmin, 0.0, -cell, ymax), dtype=np.uint8,
    )  # fmt: skip
    classes = (*(_class(word) for word in words.tolist()), class_of("unknown"))
    return ClassMap(labels, classes, Grid(rows, columns, cell, xmin, ymax))


def _class(word: str) -> MapClass:
    try:
        return class_of(word)
    except InputError:
        return class_of("unknown")


def _cell(shapes: NDArray[np.object_]) -> float | None:
    """Return the size of the cells that faces are made of, or None."""
    rings, face = shapely.get_rings(shapes, return_index=True)
    points, ring = shapely.get_coordinates(rings, return_index=True)
    along = ring[1:] == ring[:-1]
    edge = np.abs(np.diff(points, axis=0)[along])
    if not len(edge) or np.bincount(face[ring]).max() <= MANY:
        return None
    cell = float(edge.max(axis=1).min())
    if cell <= 0 or (edge.min(axis=1) > EXACT * cell).any():
        return None
    length = edge.max(axis=1) / cell
    whole = np.abs(length - np.rint(length)) < EXACT * np.maximum(length, 1)
    return cell if whole.all() and (length < 1.5).mean() > STAIRS else None
