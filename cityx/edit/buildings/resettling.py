"""Standing: buildings set on other ground, turned or drawn larger, where there is room for them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.building.lots import cleared
from cityx.city.city import City
from cityx.city.ground import ROADWAY
from cityx.edit.buildings.given_way import with_ground_freed
from cityx.edit.buildings.rebuilding import Ids, buildings_of, rebuilt
from cityx.edit.buildings.redrawn_outlines import Reshape, redrawn, rows_of
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.ids import id_text

BETWEEN = 2.0  # metres from a building that finds its own place to the next
WALKS = (
    "sidewalk",
    "kerb",
    "furnishing",
    "edging",
    "frontage",
    "water",
)  # what it leaves free besides roadways
SHARED = 0.5  # square metres by which buildings may overlap, as in a clean city
ON_STREET = 1.0  # square metres of a building on a carriageway


def reshaped(
    city: City, ids: Ids, moved: Reshape, *, turn: float = 0.0, taller: float = 1.0
) -> City:
    """Move, turn or scale the footprints of buildings, and raise them there.

    Parameters
    ----------
    city
        The city.
    ids
        Of the buildings, ascending.
    moved
        Takes (n, 2) points of one footprint's middle and corners to where they shall be.
    turn
        Radians counter-clockwise by which the footprints turn; roofs turn along.
    taller
        Factor on all heights.

    Raises
    ------
    ActionFailed
        If one would stand in another building, on a carriageway or beyond the site.
    """
    own, of_part = rows_of(city.layout, ids)
    layout = redrawn(city.layout, ids, moved, turn=turn)
    parts, buildings = layout.parts, layout.buildings
    for column in ("base", "top", "roof_height"):
        parts[column] = np.where(of_part, parts[column] * taller, parts[column])
    buildings["height"] = np.where(own, buildings["height"] * taller, buildings["height"])
    made = replace(city, layout=layout)
    _check_room(made, ids)
    return with_ground_freed(rebuilt(cleared(made, ids), ids), city.layout, ids)


def _check_room(city: City, ids: Ids) -> None:
    """Refuse footprints that lie in others, on a carriageway or beyond the site."""
    table = city.layout.buildings
    number = table["id"].to_numpy(np.uint64)
    shapes = table.geometry.to_numpy()
    mine = np.flatnonzero(np.isin(number, ids))
    reasons = [_fault(city, shapes, number, row) for row in mine.tolist()]
    said = [f"{_name(city, row)} {text}" for row, text in zip(mine.tolist(), reasons, strict=True)
            if text]  # fmt: skip
    if said:
        raise ActionFailed(f"There is no room: {'; '.join(said)}.")


def room_for(city: City, shapes: NDArray[Any], but: Ids) -> NDArray[np.bool_]:
    """(n,) whether footprints have room: in the site, beside buildings and streets."""
    free = np.asarray(shapely.covers(shapely.box(*city.layout.extent), shapes), bool)
    table = city.layout.buildings
    others = table.geometry.to_numpy()[~np.isin(table["id"].to_numpy(np.uint64), but)]
    place, _ = shapely.STRtree(others).query(shapes, predicate="dwithin", distance=BETWEEN)
    free[place] = False
    if city.ground is not None:
        ground = city.ground
        street = shapely.polygons(ground.vertices[ground.triangles_of(*ROADWAY, *WALKS)])
        free[shapely.STRtree(street).query(shapes, predicate="intersects")[0]] = False
    return free


def _fault(city: City, shapes: NDArray[Any], number: Ids, row: int) -> str:
    shape = shapes[row]
    if not shapely.covers(shapely.box(*city.layout.extent), shape):
        return "would reach beyond the site"
    others = shapely.STRtree(shapes).query(shape, predicate="intersects")
    for other in others[number[others] != number[row]].tolist():
        shared = float(shapely.area(shapely.intersection(shape, shapes[other])))
        if shared > SHARED:
            return f"would overlap {_name(city, other)} by {shared:.0f} m2"
    if city.ground is not None:
        triangles = shapely.polygons(city.ground.vertices[city.ground.triangles_of(*ROADWAY)])
        hit = triangles[shapely.STRtree(triangles).query(shape, predicate="intersects")]
        on_street = float(shapely.area(shapely.intersection(shape, hit)).sum())
        if on_street > ON_STREET:
            return f"would stand on {on_street:.0f} m2 of the carriageway"
        wet = city.ground.triangles_of("water")
        water = shapely.polygons(city.ground.vertices[wet])
        under = float(shapely.area(shapely.intersection(shape, water)).sum()) if len(wet) else 0.0
        if under > SHARED:
            return f"would stand in {under:.0f} m2 of water"
    return ""


def _name(city: City, row: int) -> str:
    building = city.layout.buildings.iloc[row]
    return str(building["name"]) or id_text(int(building["id"]))


def about(middle: FloatArray, matrix: FloatArray) -> Reshape:
    """Return what maps (n, 2) points by a (2, 2) matrix, rows times it, about a middle."""
    return lambda points: np.asarray(middle + (points - middle) @ matrix)


def middle_of(city: City, building: int) -> FloatArray:
    """Return the middle of a building's footprint, (2,) metres."""
    small = buildings_of(city.layout, np.array([building], np.uint64))
    return np.asarray(shapely.get_coordinates(small.buildings.geometry.to_numpy()[0].centroid)[0])
