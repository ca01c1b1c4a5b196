"""Land, water and green: the areas of a city by kind; areas that touch count as one place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates import words
from cityx.checks.predicates.building_predicates import box_sides, looks_of_faces
from cityx.checks.predicates.thing_predicates import CannotTell, Layer, UInt64Array, column
from cityx.city import City
from cityx.city.layout import of_kinds
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.ground.ground_looks import area_faces

TOUCH = 0.5  # metres between pieces of one area
WALL, LEAST_COURT = 1.5, 100.0  # metres of half a gap in a block; square metres of a courtyard
# Kinds whose width is that of a bent strip; others are as long and wide as the box round them.
STRIPS = ("river", "canal", "sea", "lake", "water", "beach", "park", "wood", "green", "grass")
# Kinds that a tag of the area tells from another one.
TAGGED: Mapping[tuple[str, str], str] = {
    ("canal", "river"): '"water": "canal"', ("breakwater", "pier"): '"man_made": "breakwater"',
}  # fmt: skip


def places_of(city: City, word: str) -> NDArray[Any]:
    """Return the plazas, parks, lakes, ... of a city: a key of `words.LANDS`, as polygons.

    Pieces of a place that touch are one; a place has at least 300 square metres. A beach is sand
    beside water, a courtyard what buildings enclose.
    """
    if word == "island":
        return _islands(city)
    if word == "courtyard":
        return _courtyards(city)
    shapes = _rows(city, word).geometry.to_numpy()
    if not len(shapes):
        return np.zeros(0, object)
    if word not in words.WHOLE:
        return np.asarray(shapes[shapely.area(shapes) >= words.SMALLEST_OTHER], object)
    grown = shapely.union_all(shapely.buffer(shapes, TOUCH, join_style="mitre"))
    found = shapely.get_parts(shapely.buffer(grown, -TOUCH, join_style="mitre"))
    found = np.asarray(found[shapely.area(found) >= words.SMALLEST])
    return _by_water(city, found) if word == "beach" else found


def _rows(city: City, word: str) -> Any:
    """Return the areas of the layout that make up land of a kind; a canal is tagged as one."""
    table = city.layout.areas
    own = of_kinds(table, words.LANDS[word])
    special = next((pair for pair in TAGGED if word in pair), None)
    if special is not None and own.any():
        tagged = table["tags"].str.contains(TAGGED[special], regex=False).to_numpy(bool)
        own = own & (tagged if word == special[0] else ~tagged)
    return table[own]


def _courtyards(city: City) -> NDArray[Any]:
    """Return the ground that buildings enclose on all sides."""
    stand = shapely.buffer(city.layout.buildings.geometry.to_numpy(), WALL, join_style="mitre")
    joined = shapely.buffer(shapely.union_all(stand), -WALL, join_style="mitre")
    found = [
        shapely.Polygon(ring) for part in shapely.get_parts(joined).tolist()
        for ring in part.interiors
    ]  # fmt: skip
    return np.array([one for one in found if one.area >= LEAST_COURT], object)


def _islands(city: City) -> NDArray[Any]:
    """Return the land with water all round it within the site."""
    site = shapely.box(*city.layout.extent)
    water = shapely.union_all(
        shapely.buffer(_rows(city, "water").geometry.to_numpy(), TOUCH, join_style="mitre")
    )
    land = shapely.get_parts(shapely.difference(site, water))
    inner = shapely.distance(land, site.exterior) > TOUCH
    return np.asarray(land[inner & (shapely.area(land) >= words.SMALLEST_OTHER)], object)


def rivers_meeting(city: City) -> int:
    """Return how many rivers flow together at most: one less than leave the site as one water."""
    border = shapely.buffer(shapely.box(*city.layout.extent).exterior, 2 * TOUCH)
    ends = [
        len(shapely.get_parts(shapely.intersection(shape, border)))
        for shape in places_of(city, "river").tolist()
    ]
    return max(max(ends, default=0) - 1, 0)


def _by_water(city: City, shapes: NDArray[Any]) -> NDArray[Any]:
    table = city.layout.areas
    water = table.geometry.to_numpy()[table["kind"].isin(words.LANDS["water"]).to_numpy()]
    tree = shapely.STRtree(water)
    near, _ = tree.query(shapes, predicate="dwithin", distance=words.SHORE)
    return np.asarray(shapes[np.unique(near)])


@dataclass(frozen=True)
class Lands(Layer):
    """The places of one kind."""

    @cached_property
    def _table(self) -> Any:
        return _rows(self.city, self.kind)

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(n,) polygons."""
        return places_of(self.city, self.kind)

    @cached_property
    def _pieces(self) -> tuple[IntArray, IntArray]:
        """Return pairs of a place and a row of the layout's areas of the kind that makes it up."""
        inner = shapely.point_on_surface(self._table.geometry.to_numpy())
        place, row = shapely.STRtree(inner).query(self.shapes, predicate="intersects")
        return place, row

    @cached_property
    def ids(self) -> UInt64Array:
        """(n,) least id of the areas of each."""
        place, row = self._pieces
        least = np.full(len(self.shapes), np.iinfo(np.uint64).max, np.uint64)
        np.minimum.at(least, place, self._table["id"].to_numpy(np.uint64)[row])
        return least

    def members(self, rows: IntArray) -> UInt64Array:
        """Return the ids of the areas."""
        place, row = self._pieces
        return np.asarray(self._table["id"].to_numpy(np.uint64)[row[np.isin(place, rows)]])

    @cached_property
    def names(self) -> Mapping[str, NDArray[Any]]:
        """Names and sources of the first area of each."""
        ids = self._table["id"].to_numpy(np.uint64)
        rows = np.minimum(np.searchsorted(ids, self.ids), max(len(ids) - 1, 0))
        return {key: column(self._table, key)[rows] for key in ("name", "source")}

    def number(self, attribute: str) -> FloatArray:
        """Return areas, or widths of what is long, such as a river."""
        if attribute == "area":
            return np.asarray(shapely.area(self.shapes))
        if attribute in ("length", "width") and self.kind not in STRIPS:
            return box_sides(self.shapes)[:, int(attribute == "width")]
        if attribute == "width":
            return strip_width(self.shapes)
        if attribute == "length":
            return np.asarray(shapely.area(self.shapes) / strip_width(self.shapes))
        return super().number(attribute)

    def has(self, attribute: str, word: str) -> BoolArray:
        """Return which are mainly paved with a material, or of a colour."""
        if attribute == "material":
            return np.isin(self._looks[0], words.COVERS[word])
        if attribute == "color":
            return np.asarray(self._looks[1] == word)
        return super().has(attribute, word)

    @cached_property
    def _looks(self) -> tuple[NDArray[np.str_], NDArray[np.str_]]:
        """(n,) roots of the materials that cover most of each, and words of their colours."""
        mesh = self.city.scene.meshes.get("ground")
        if mesh is None:
            raise CannotTell("the ground is not laid yet, so it has no material or colour")
        place, row = self._pieces
        faces, owner = area_faces(self.city, mesh, self._table["id"].to_numpy(np.uint64)[row])
        ids = self._table["id"].to_numpy(np.uint64)[row]
        order = np.argsort(ids, kind="stable")
        of = place[order][np.searchsorted(ids[order], owner)]
        return looks_of_faces(mesh, faces, of, len(self.shapes))


def strip_width(shapes: NDArray[Any]) -> FloatArray:
    """Return the width of polygons taken for bent strips, (n,) metres, from area and border.

    A strip of length L and width w has the area L w and the border 2 (L + w); a round shape, which
    is no strip, gets the side of the square of its area. Round islands it is that of the water.
    """
    whole = shapely.get_type_id(shapes) == shapely.GeometryType.POLYGON
    rim = np.where(whole, shapely.get_exterior_ring(shapes), shapely.boundary(shapes))
    area, border = shapely.area(shapes), shapely.length(rim)
    root = np.sqrt(np.maximum(border**2 - 16 * area, 0.0))
    return np.asarray((border - root) / 4)
