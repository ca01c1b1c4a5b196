"""Measures of meshes: outline, size, front, whether they can be an asset, and sentences on them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.assets.styles.materials import srgb_to_linear
from cityx.geometry.arrays import FloatArray, IntArray

SIMPLE = 0.005  # of the longer side: detail of outlines below it is left out
LEAST_SIMPLE = 0.002  # metres
MOST_JOINED = 60_000  # triangles; beyond it the outline is the convex hull
FLAT = 1e-9  # square metres; a triangle seen edge-on covers no ground
SNAP = 1e-4  # metres
# sRGB of colour words; the nearest by Euclid in the sRGB cube names a colour well enough.
COLORS = {
    "white": 0xF0EEE8, "cream": 0xEDE3C8, "light grey": 0xC0C0BE, "grey": 0x8C8C8A,
    "dark grey": 0x50504F, "black": 0x1C1C1C, "red": 0xA03028, "brick red": 0x96503C,
    "brown": 0x6E4A34, "dark brown": 0x422C20, "beige": 0xC8AF8C, "yellow": 0xDCB95A,
    "ochre": 0xB88638, "orange": 0xC8783C, "olive": 0x6E6E46, "green": 0x5A7D50,
    "dark green": 0x2E4632, "blue": 0x50729B, "dark blue": 0x24406B, "pink": 0xD7A5A0,
}  # fmt: skip
_LINEAR = np.array([srgb_to_linear(value) for value in COLORS.values()])
_NAMES = np.array(list(COLORS))

USES = {
    "house": "detached house", "flats": "apartment building", "office": "office building",
    "retail": "shop building", "industry": "industrial hall", "worship": "church",
    "civic": "public building", "shed": "shed",
}  # fmt: skip
MATERIALS = {
    "plaster": "plaster", "brick": "brick", "stone": "stone", "concrete": "concrete",
    "wood": "timber boards", "metal_panel": "metal cladding", "glass_wall": "glass",
    "roof_tiles": "tiles", "slate": "slate", "roof_metal": "metal", "copper": "copper",
    "bitumen": "felt", "roof_gravel": "gravel", "thatch": "thatch",
}  # fmt: skip
PARTIES = {0: "freestanding", 1: "attached on the left", 2: "attached on the right",
           3: "terraced between neighbours"}  # fmt: skip


def outline_of(vertices: FloatArray, triangles: IntArray | None) -> Any:
    """Return the outline of what a mesh covers seen from above, a polygon without holes.

    Parameters
    ----------
    vertices
        (n, 3) metres.
    triangles
        (t, 3) rows of vertices. The outline is the union of the triangles; the convex hull where
        there are none, too many, or they do not join into one piece of most of the hull's area.

    Returns
    -------
    outline
        Empty if the mesh covers no ground.
    """
    points = np.asarray(vertices, float)[:, :2]
    hull = shapely.convex_hull(shapely.multipoints(points))
    if shapely.get_type_id(hull) != 3:
        return shapely.Polygon()
    extent = np.ptp(points, axis=0).max()
    step = max(SIMPLE * extent, LEAST_SIMPLE)
    if triangles is None or len(triangles) > MOST_JOINED:
        return _counter_clockwise(shapely.simplify(hull, step / 4))
    corner = points[triangles]  # (t, 3, 2)
    a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    solid = shapely.polygons(corner[area > FLAT])
    if not len(solid):
        return _counter_clockwise(hull)
    joined = shapely.union_all(shapely.buffer(shapely.union_all(solid, grid_size=SNAP), step,
                                              join_style="mitre"))  # fmt: skip
    joined = shapely.buffer(joined, -step, join_style="mitre")
    pieces = shapely.get_parts(joined)
    if not len(pieces):
        return _counter_clockwise(hull)
    largest = pieces[np.argmax(shapely.area(pieces))]
    # Two pieces, such as a house and its garage: only the hull covers both.
    if shapely.area(pieces).sum() > 1.02 * shapely.area(largest):
        return _counter_clockwise(hull)
    outline = shapely.simplify(shapely.Polygon(largest.exterior), step)
    return _counter_clockwise(outline if shapely.is_valid(outline) else hull)


def stable_outline(outline: Any) -> Any:
    """Round an outline to millimetres, so that machines agree on it."""
    rounded = shapely.set_precision(outline, 1e-3)
    return outline if shapely.is_empty(rounded) else _counter_clockwise(rounded)


def _counter_clockwise(polygon: Any) -> Any:
    return shapely.normalize(shapely.orient_polygons(polygon))


def front_of(
    vertices: FloatArray,
    triangles: IntArray,
    names: Sequence[str],
    number: NDArray[np.int64],
    outline: Any,
) -> float:
    """Guess which way an asset faces, compass radians.

    Where parts are named after doors or entrances, it is the side of the smallest rectangle that
    they are nearest to. Else it is -y: the front of glTF, USD and Blender files.

    Parameters
    ----------
    vertices, triangles
        (n, 3) and (t, 3).
    names, number
        Names of materials and parts, and (t,) which one each triangle has.
    outline
        Outline of the asset.
    """
    from cityx.geometry.rectangles import rectangles_of

    words = ("door", "entrance", "entry", "portal", "porch", "shopfront", "storefront")
    doors = [i for i, name in enumerate(names) if any(word in name.lower() for word in words)]
    hit = np.isin(number, doors)
    if not hit.any():
        return float(np.pi)
    box = rectangles_of(np.array([outline], object))
    middle = vertices[triangles[hit]].mean(axis=(0, 1))[:2] - box.centre[0]
    axis = np.array([np.cos(box.angle[0]), np.sin(box.angle[0])])
    across = np.array([-axis[1], axis[0]])
    share = np.array(
        [
            middle @ axis / max(box.length[0] / 2, 1e-9),
            middle @ across / max(box.width[0] / 2, 1e-9),
        ]
    )
    way = axis * np.sign(share[0]) if abs(share[0]) > abs(share[1]) else across * np.sign(share[1])
    return float(np.arctan2(way[0], way[1]) % (2 * np.pi))


def color_words(linear: ArrayLike) -> NDArray[np.str_]:
    """Name (n, 3) linear colours, (n,)."""
    rgb = np.sqrt(np.clip(np.asarray(linear, float).reshape(-1, 3), 0, 1))  # near the sRGB curve
    known = np.sqrt(_LINEAR)
    gap = ((rgb[:, None, :] - known[None]) ** 2).sum(axis=2)
    return np.asarray(_NAMES[gap.argmin(axis=1)])


def building_sentence(
    *,
    use: str,
    style: str,
    generator: str,
    levels: int,
    height: float,
    size: Sequence[float],
    wall: tuple[str, str],
    roof: tuple[str, str],
    party: int,
) -> str:
    """Describe a building.

    Parameters
    ----------
    use, style, generator
        Use group, style family and kind of building.
    levels, height
        Storeys, and metres to the top.
    size
        Front and depth, metres.
    wall
        Colour word and material of the walls.
    roof
        Shape and material of the roof.
    party
        Sides without openings: 1 left, 2 right.
    """
    front, depth = size
    wall_word = MATERIALS.get(wall[1], wall[1].replace("_", " "))
    roof_word = MATERIALS.get(roof[1], roof[1].replace("_", " "))
    return (
        f"{style.capitalize()} {USES.get(use, use)} as {generator}, {levels} "
        f"{'storey' if levels == 1 else 'storeys'}, {height:.0f} m high, {wall[0]} {wall_word} "
        f"walls, {roof[0]} roof of {roof_word}, {PARTIES.get(party, 'attached')}, "
        f"{front:.0f} by {depth:.0f} m."
    )


def thing_sentence(words: str, size: Sequence[float]) -> str:
    """Describe anything else by its words and its (length, width, height)."""
    length, width, height = (f"{value:.0f}" if value >= 10 else f"{value:.1f}" for value in size)
    return f"{words[:1].upper()}{words[1:]}, {length} m long, {width} m wide, {height} m high."
