"""Blocks of a district: what its streets enclose, and what each is for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.special import ndtri

from cityx.geometry.arrays import FloatArray
from cityx.geometry.parcels.winding_patterns import SQUARE
from cityx.ids import UInt64Array, choose, stable_id, uniform
from cityx.town.districts import District
from cityx.town.plane import DENSITY, ZONES, Plane
from cityx.town.procedural_streets import half_width, local_tags, main_rank, side_tags

BUSY = ("primary", "secondary")  # main roads with shops along them
STRIPS, STRIP_SIZE, STRIP_REACH = 0.15, 3000.0, 16.0  # share, square metres, metres to the road
CAMPUSES, CAMPUS_SIZE = 0.12, 11_000.0  # share of the large blocks, square metres
HIGH = (30.0, 110.0)  # metres of towers where the core begins and where it is densest
FILLET = 4  # segments of a quarter of a circle round the corner of a block
LEAST = 220.0  # square metres; less is left as green between streets
THIN = 4.0  # metres; what is narrower does not count to a block
LARGEST_PARK = 2.2  # times the share still wanted that a park may take
# What open country is used for, by weight.
FIELDS: Mapping[str, int] = {"farmland": 5, "meadow": 3, "wood": 2}
OPEN_FIELD = 0.75  # share of the blocks of open country that have no houses
# Land that a zone's blocks stand on.
LAND: Mapping[str, str] = {
    "core": "commercial", "midrise": "residential", "row": "residential", "suburb": "residential",
    "semi": "residential",
    "rural": "residential", "industry": "industrial", "slab": "residential", "campus": "civic",
    "retail strip": "retail",
}  # fmt: skip


@dataclass(frozen=True)
class Blocks:
    """Blocks of one district, b of them, in the district's own frame.

    Attributes
    ----------
    shapes
        (b,) polygons between the walks of the streets, metres.
    ids
        (b,) stable ids.
    zone
        (b,) a zone of `cityx.geometry.parcels.parcels.SCHEMES`, or "" where nothing is built.
    kind
        (b,) of the land: "residential", "park", "pedestrian", ...
    density
        (b,) 0 to 1, from the least to the most dense place of the zone.
    height
        (b,) metres that main buildings shall have, NaN where the zone decides.
    """

    shapes: NDArray[Any]
    ids: UInt64Array
    zone: NDArray[Any]
    kind: NDArray[Any]
    density: FloatArray
    height: FloatArray


def blocks_of(plane: Plane, district: District, out: Any = None) -> Blocks:
    """Find the blocks of a district and say what each is for.

    Parameters
    ----------
    out
        A shape in the district's frame on which there are none, if there is one.
    """
    sketch = district.sketch
    key = sketch.rim.key
    shapes = _between_streets(plane, district, out)
    numbers = range(len(shapes))
    ids = np.array([stable_id("town", *key, "block", k) for k in numbers], np.uint64)
    points = shapely.get_coordinates(shapely.point_on_surface(shapes)).reshape(-1, 2)
    density = plane.density(sketch.rim.places(points))
    zone = plane.zone(density, ids)
    if sketch.zone == "industry":
        zone[:] = "industry"
    elif sketch.kind == "superblock":
        zone[np.isin(zone, ["midrise", "core"])] = "slab"
    _set_apart(plane, district, shapes, ids, zone)
    kind = np.array([LAND[word] for word in zone], object)
    area = shapely.area(shapes)
    green = _parks(plane, ids, area)
    kind[green], zone[green] = "park", ""
    _leave_open(plane, ids, zone, kind)
    _lay_plaza(plane, district, shapes, zone, kind)
    small = area < LEAST
    kind[small], zone[small] = "grass", ""
    within, height = _within_zone(plane, ids, zone, density)
    return Blocks(shapes, ids, zone, kind, within, height)


def _set_apart(
    plane: Plane, district: District, shapes: NDArray[Any], ids: UInt64Array, zone: NDArray[Any]
) -> None:
    """Give some blocks to shops along main roads, and some large ones to schools and the like."""
    if plane.plan.zone:
        return
    rim, area = district.sketch.rim, shapely.area(shapes)
    drawn = uniform(plane.seed, "block/apart", ids)
    ranks = [side.kind == "road" and main_rank(plane, rim.key, side.beyond) in BUSY for side in rim.sides]  # fmt: skip  # noqa: E501
    busy = shapely.multilinestrings(rim.lines()[ranks])
    beside = (
        shapely.distance(shapes, busy) < STRIP_REACH if any(ranks) else np.zeros(len(ids), bool)
    )
    shops = beside & np.isin(zone, ["row", "suburb"]) & (area > STRIP_SIZE)
    zone[shops & (drawn < STRIPS)] = "retail strip"
    wide = np.isin(zone, ["midrise", "row", "suburb"]) & (area > CAMPUS_SIZE)
    zone[wide & (drawn > 1.0 - CAMPUSES)] = "campus"


def _within_zone(
    plane: Plane, ids: UInt64Array, zone: NDArray[Any], density: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the density within the range of each block's zone, and the heights it asks for."""
    edges = dict(zip(ZONES, pairwise((1.0, *DENSITY, 0.0)), strict=True))
    high, low = np.array([edges.get(word, (1.0, 0.0)) for word in zone]).reshape(-1, 2).T
    within = np.clip((density - low) / (high - low), 0.0, 1.0)
    rise = np.exp(np.log(HIGH[0]) + within * np.log(HIGH[1] / HIGH[0]))
    rough = np.exp(0.25 * ndtri(0.02 + 0.96 * uniform(plane.seed, "block/height", ids)))
    return within, np.where(zone == "core", np.round(rise * rough, 1), np.nan)


def _between_streets(plane: Plane, district: District, out: Any) -> NDArray[Any]:
    """Return what streets and their walks leave of a district, in an order of their places."""
    sketch = district.sketch
    rim = sketch.rim
    lines = [shapely.LineString(rim.local(side.line)) for side in rim.sides]
    half = [half_width(side_tags(plane, rim.key, side), plane.profile) for side in rim.sides]
    ends = rim.local(district.places)[district.links]
    lines += list(shapely.linestrings(ends))
    streets, of = np.unique(district.street, axis=0, return_inverse=True)
    own = [
        half_width(
            local_tags(plane, rim.key, sketch.zone, sketch.kind, family, line), plane.profile
        )
        for family, line in streets.tolist()
    ]
    half += [own[k] for k in of.ravel().tolist()]
    strips = shapely.buffer(np.array(lines, object), np.array(half), quad_segs=FILLET)
    rest = shapely.difference(rim.polygon(), shapely.union_all(strips))
    if out is not None:
        rest = shapely.difference(rest, out)
    opened = shapely.buffer(shapely.buffer(rest, -THIN / 2, quad_segs=FILLET), THIN / 2, quad_segs=FILLET)  # fmt: skip  # noqa: E501
    found = shapely.get_parts(shapely.intersection(rest, opened))
    found = found[(shapely.get_type_id(found) == 3) & (shapely.area(found) > THIN**2)]
    found = shapely.orient_polygons(shapely.simplify(found, 0.02))
    box = np.round(shapely.bounds(found), 3)
    return np.asarray(found[np.lexsort(box.T)])


def _parks(plane: Plane, ids: UInt64Array, area: FloatArray) -> NDArray[np.bool_]:
    """Choose the parks of a district: blocks in drawn order until the share is reached."""
    green = np.zeros(len(ids), bool)
    wanted = plane.plan.parks * area.sum()
    # What a district misses or exceeds is drawn, so that not every one has the same share.
    wanted *= 0.5 + float(uniform(plane.seed, "district/parks", ids[:1], 1)[0]) if len(ids) else 0.0
    for row in np.argsort(uniform(plane.seed, "block/park", ids), kind="stable").tolist():
        left = wanted - area[green].sum()
        if left <= 0.25 * wanted:
            break
        green[row] = LEAST < area[row] <= LARGEST_PARK * left
    return green


def _leave_open(plane: Plane, ids: UInt64Array, zone: NDArray[Any], kind: NDArray[Any]) -> None:
    """Turn most blocks of open country into fields, meadows and woods."""
    rural = np.flatnonzero(zone == "rural")
    rows = rural[uniform(plane.seed, "block/open", ids[rural]) < OPEN_FIELD]
    words = np.array(list(FIELDS), object)
    kind[rows] = words[choose(plane.seed, "block/field", ids[rows], list(FIELDS.values()))]
    zone[rows] = ""


def _lay_plaza(
    plane: Plane, district: District, shapes: NDArray[Any], zone: NDArray[Any], kind: NDArray[Any]
) -> None:
    """Turn the block at the middle of a dense district, or in a site's square, into a plaza."""
    if (district.street[:, 0] == SQUARE).any():
        best = int(np.argmin(shapely.distance(shapes, shapely.Point(0.0, 0.0))))
        kind[best], zone[best] = "pedestrian", ""
        return
    dense = np.isin(zone, ["core", "midrise"])
    ident = stable_id("town", *district.sketch.rim.key)
    if not dense.any() or uniform(plane.seed, "district/plaza", ident) >= plane.plan.plazas:
        return
    rows = np.flatnonzero(dense)
    fit = shapely.area(shapes[rows])
    # The smaller and the nearer to the middle, the better it suits.
    away = shapely.distance(shapes[rows], shapely.Point(0.0, 0.0))
    best = rows[int(np.argmin(np.abs(np.log(fit / 2500.0)) + away / 60.0))]
    if shapely.area(shapes[best]) < 9000.0:
        kind[best], zone[best] = "pedestrian", ""
