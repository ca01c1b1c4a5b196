"""From faces: lines, points, boxes, solids, images and rows of the layout."""

from __future__ import annotations

from typing import Annotated

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.layout import AREA_KINDS, Layout, make_table
from cityx.city.mesh import MeshBatch
from cityx.convert.points import extent_of
from cityx.errors import InputError
from cityx.geometry.raster.grid import Grid
from cityx.ids import stable_id, uniform
from cityx.protocol import Port, Range, action
from cityx.protocol.solid_blocks import raise_outlines
from cityx.protocol.values import (
    Boxes,
    Image,
    LinearColor,
    Lines,
    Points,
    Surfaces,
    make_boxes,
    make_lines,
    make_points,
)
from cityx.sources.class_map import ClassMap, layout_of
from cityx.sources.map_classes import MapClass, class_of

# Pixels within faces: faces joined from the cells of a map are recognised by their stairs.

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


LEVEL_HEIGHT = 3.0  # metres of a storey where nothing is said
SMALLEST = 1e-6  # square metres; smaller faces enclose nothing


@action(
    "convert/face_to_line_conversion-v1",
    classname="Face_to_line_conversion",
    extension=True,
    lossy=0.1,
    limits=["Loses heights and which ring is a hole of which."],
)
def face_to_line_conversion(surfaces: Surfaces) -> Lines:
    """Convert faces to the closed lines around them and around their holes.

    Parameters
    ----------
    surfaces
        Faces.
    """
    rings, row = shapely.get_rings(surfaces.geometry, return_index=True)
    points, part = shapely.get_coordinates(rings, return_index=True)
    lines = shapely.linestrings(points, indices=part) if len(rings) else []
    return make_lines(lines, surfaces.kind[row].tolist(), object_id=surfaces.object_id[row])


@action(
    "convert/face_to_point_conversion-v1",
    classname="Face_to_point_conversion",
    extension=True,
    lossy=0.3,
    limits=["Loses outlines finer than the spacing; a face smaller than a cell may get no point."],
)
def face_to_point_conversion(
    surfaces: Surfaces, *, spacing: Annotated[float, Range(0.01, 1000.0)] = 1.0
) -> Points:
    """Convert faces to the points of a square grid that lie in them.

    Parameters
    ----------
    surfaces
        Faces.
    spacing
        Distance between points, metres.
    """
    places: list[NDArray[np.float64]] = []
    rows: list[NDArray[np.int64]] = []
    bounds = shapely.bounds(surfaces.geometry)
    for row, (shape, box) in enumerate(zip(surfaces.geometry, bounds, strict=True)):
        low = np.ceil(box[:2] / spacing - 0.5).astype(np.int64)
        high = np.floor(box[2:] / spacing - 0.5).astype(np.int64)
        grid = np.mgrid[low[0] : high[0] + 1, low[1] : high[1] + 1].reshape(2, -1).T
        xy = (grid + 0.5) * spacing
        shapely.prepare(shape)
        inside = xy[shapely.contains_xy(shape, xy)]
        places.append(inside)
        rows.append(np.full(len(inside), row))
    if not places:
        return make_points(np.zeros((0, 3)))
    return make_points(np.concatenate(places), surfaces.kind[np.concatenate(rows)].tolist())


@action(
    "convert/face_to_box_conversion-v1",
    classname="Face_to_box_conversion",
    extension=True,
    lossy=0.4,
    limits=["Loses the outline: what remains is the smallest rectangle around it."],
)
def face_to_box_conversion(
    surfaces: Surfaces, *, height: Annotated[float, Range(0.01, 1000.0)] = LEVEL_HEIGHT
) -> Boxes:
    """Convert faces to the smallest upright boxes around them.

    Parameters
    ----------
    surfaces
        Faces.
    height
        Height of boxes on faces that do not carry their own, metres.
    """
    kept = shapely.area(surfaces.geometry) > SMALLEST
    rectangles = shapely.minimum_rotated_rectangle(surfaces.geometry[kept])
    corners = shapely.get_coordinates(rectangles).reshape(-1, 5, 2)
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 1]
    a, b = np.hypot(*first.T), np.hypot(*second.T)
    along = np.where((a >= b)[:, None], first, second)
    heights = np.where(np.isnan(surfaces.height), height, surfaces.height)[kept]
    centre = corners[:, :4].mean(axis=1)
    return make_boxes(
        np.column_stack([centre, np.zeros(len(centre))]),
        np.column_stack([np.maximum(a, b), np.minimum(a, b), heights]),
        np.arctan2(along[:, 0], along[:, 1]) % np.pi,
        surfaces.kind[kept].tolist(),
        surfaces.object_id[kept],
    )


@action(
    "convert/face_to_solid_conversion-v1",
    classname="Face_to_solid_conversion",
    extension=True,
    limits=["Loses the class; faces that carry no height become slabs of the thickness given."],
    lossy=0.05,
)
def face_to_solid_conversion(
    surfaces: Surfaces, *, thickness: Annotated[float, Range(0.001, 1000.0)] = 0.1
) -> MeshBatch:
    """Convert faces to closed solids, raised from level zero to their heights.

    Parameters
    ----------
    surfaces
        Faces.
    thickness
        Height of faces that do not carry their own, metres.
    """
    kept = shapely.area(surfaces.geometry) > SMALLEST
    heights = np.where(np.isnan(surfaces.height), thickness, surfaces.height)[kept]
    return raise_outlines(
        surfaces.geometry[kept],
        0.0,
        heights,
        object_id=surfaces.object_id[kept],
        wall="concrete",
        roof="concrete",
    )


@action(
    "convert/face_to_image_conversion-v1",
    classname="Face_to_image_conversion",
    extension=True,
    gives=(Port("image", "image", "semantic_map"),),
    lossy=0.4,
    limits=["Loses outlines finer than a pixel and heights; later faces cover earlier ones."],
)
def face_to_image_conversion(
    surfaces: Surfaces,
    *,
    pixel_size: Annotated[float, Range(0.01, 1000.0)] = 1.0,
    most_pixels: Annotated[int, Range(16, 16384)] = 4096,
) -> Image:
    """Convert faces to a semantic map, one colour for each class, black where there is none.

    Parameters
    ----------
    surfaces
        Faces.
    pixel_size
        Metres; raised when the map would be larger than `most_pixels` on a side.
    most_pixels
        Greatest number of pixels on a side.
    """
    low, high = np.zeros(2), np.full(2, pixel_size)
    if surfaces.count:
        bounds = shapely.total_bounds(surfaces.geometry)
        low, high = bounds[:2], bounds[2:]
    size = max(pixel_size, float((high - low).max()) / most_pixels)
    columns, rows = np.maximum(1, np.ceil((high - low) / size - 1e-9)).astype(int).tolist()
    words = sorted(set(surfaces.kind.tolist()))
    classes = tuple((class_color(word), word) for word in words)
    pixels = np.zeros((rows, columns, 3))
    x = low[0] + (np.arange(columns) + 0.5) * size
    y = low[1] + (np.arange(rows) + 0.5) * size
    for shape, kind in zip(surfaces.geometry, surfaces.kind.tolist(), strict=True):
        box = shapely.bounds(shape)
        i = slice(*np.searchsorted(y, [box[1], box[3]]).tolist())
        j = slice(*np.searchsorted(x, [box[0], box[2]]).tolist())
        shapely.prepare(shape)
        inside = shapely.contains_xy(shape, x[None, j], y[i, None])
        pixels[i, j][inside] = class_color(kind)
    return Image(pixels[::-1].copy(), size, (float(low[0]), float(low[1])), classes)


def class_color(word: str) -> LinearColor:
    """Return the colour that stands for a class in maps: never black, the same everywhere."""
    u = uniform(0, "class_color", np.uint64(stable_id(word)), np.arange(3))
    # Whole 255ths, so that an eight-bit file reads back as the same colour.
    red, green, blue = (np.rint(40 + 215 * u) / 255).tolist()
    return LinearColor(red, green, blue)


@action(
    "convert/face_to_layout_conversion-v1",
    classname="Face_to_layout_conversion",
    extension=True,
    lossy=0.1,
    limits=[
        "Loses classes the layout has no word for: such faces become residential land.",
        "Faces with stairs for borders are pixels of a map and are drawn as what they stand for.",
    ],
)
def face_to_layout_conversion(
    city: City, surfaces: Surfaces, *, levels: Annotated[int, Range(1, 200)] = 3
) -> Layout:
    """Convert faces to rows of the layout: buildings with their part, and areas.

    Parameters
    ----------
    city
        City whose frame and seed the layout is for.
    surfaces
        Faces; classes are "building", a use such as "apartments", or a word such as "park".
    levels
        Storeys of buildings whose face carries no height.
    """
    pixels = pixels_of(surfaces)
    if pixels is not None:
        return layout_of(pixels, city.frame, source="face", seed=city.seed)[0]
    shapes = shapely.orient_polygons(shapely.force_2d(surfaces.geometry))
    words = surfaces.kind.astype(object)
    words = np.where(np.isin(surfaces.kind, ROAD_WORDS), "road_area", words)
    built = np.isin(surfaces.kind, BUILDING_WORDS)
    area = ~built
    ids = surfaces.object_id.copy()
    for row in np.flatnonzero(ids == 0).tolist():
        middle = np.round(shapely.get_coordinates(shapely.centroid(shapes[row]))[0], 3)
        ids[row] = stable_id("face", words[row], *middle, round(shapely.area(shapes[row]), 3))
    height = surfaces.height[built]
    height = np.where(np.isnan(height), levels * LEVEL_HEIGHT, height)
    storeys = np.maximum(1, np.rint(height / LEVEL_HEIGHT)).astype(np.int16)
    use = np.where(words[built] == "building", "yes", words[built])
    count = int(built.sum())
    source = np.full(count, "face")
    buildings = make_table(
        "buildings", shapes[built], id=ids[built], source=source, use=use, levels=storeys,
        height=height, place=np.full(count, "urban"),
    )  # fmt: skip
    parts = make_table(
        "parts", shapes[built], id=[stable_id("part", int(i)) for i in ids[built]],
        building=ids[built], use=use, base=np.zeros(count), top=height, levels=storeys,
        roof_shape=np.full(count, "flat"), roof_height=np.zeros(count),
        roof_direction=np.full(count, np.nan), walls=np.ones(count, bool),
        wall_color=np.full(count, -1), roof_color=np.full(count, -1),
    )  # fmt: skip
    kinds = np.where(np.isin(words[area].astype(str), AREA_KINDS), words[area], "residential")
    areas = make_table(
        "areas", shapes[area], id=ids[area], source=np.full(int(area.sum()), "face"), kind=kinds
    )
    return Layout(
        extent_of(shapely.get_coordinates(shapes)), buildings=buildings, parts=parts, areas=areas
    )


BUILDING_WORDS = (
    "building", "yes", "apartments", "house", "detached", "terrace", "residential_building",
    "office", "retail_building", "industrial_building", "warehouse", "hotel", "school",
    "hospital", "church", "garage", "public", "civic_building", "skyscraper",
)  # fmt: skip
ROAD_WORDS = (
    "road", "street", "motorway", "trunk", "primary", "secondary", "tertiary", "unclassified",
    "living_street", "service", "road_area",
)  # fmt: skip
