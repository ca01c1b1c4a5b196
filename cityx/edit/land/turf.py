"""Grass laid on squares, in yards and around houses that exist."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.layout import joined_tables, make_table
from cityx.edit.land.open_ground import ways_of
from cityx.edit.land.spots import CORNERS
from cityx.edit.renewal import renewed
from cityx.errors import UsageError
from cityx.geometry.polygons import region_of_corners
from cityx.ids import hash_ids, id_text, stable_id
from cityx.protocol import Choice, ObjectName, Points, Port, Range, Serves, action
from cityx.protocol.objects import find_objects

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

ACTION = "edit/turf-v1"
KINDS = ("grass", "meadow")
GREEN = ("park", "garden", "grass", "meadow", "golf", "cemetery", "wood")
WET = ("water", "sea", "river", "pool", "wetland")
LEAST = 4.0  # square metres of a piece of lawn
REACH = 8.0  # metres of lawn around a house or along a street


@action(
    ACTION,
    limits=[
        "A square or a yard becomes lawn as a whole; its trees, benches and paths stay.",
        "Nothing grows on streets, walks and water.",
    ],
    requires=("layout",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    serves=(
        Serves("edit=add", "element=lawn", "within"),
        Serves("edit=add", "element=lawn", "beside"),
        Serves("edit=add", "element=meadow", "within", kind="meadow"),
        Serves("edit=add", "element=meadow", "beside", kind="meadow"),
        Serves("edit=add", "element=lawn", "ground"),
        Serves("edit=add", "element=meadow", "ground", kind="meadow"),
    ),
    binds={"within": "within", "beside": "beside", "ground": "ground"},
    labels=("grass", "lawn", "turf", "meadow", "green"),
)
def turf(
    city: City,
    *,
    within: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    beside: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    ground: Annotated[tuple[tuple[float, ...], ...] | None, Points(3, CORNERS)] = None,
    kind: Annotated[str, Choice(*KINDS)] = "grass",
    reach: Annotated[float, Range(1.0, 50.0)] = REACH,
) -> City:
    """Lay grass on areas, and on the land around houses and along streets.

    Parameters
    ----------
    city
        The city.
    within, beside
        Areas that become lawn, and houses and streets beside which the land does.
    ground
        Corners of polygons of which the free land does: x, y and which polygon.
    kind
        What grows there.
    reach
        Metres of it beside houses and streets.
    """
    names = (*(within or ()), *(beside or ()))
    if not names and ground is None:
        raise UsageError("Nothing is said of the place: a square, a house or a street.")
    ids = find_objects(city, names)
    areas = city.layout.areas.copy()
    own = np.isin(areas["id"].to_numpy(np.uint64), ids)
    sown = own & ~areas["kind"].isin((*GREEN, *WET)).to_numpy()
    areas.loc[sown, "kind"] = kind
    around = _around(city, ids, reach)
    if ground is not None:
        told = _free_land(city, np.array([region_of_corners(ground)], object))
        around = np.array([*around, *told], object)
    if len(around):
        key = int(ids[0]) if len(ids) else _key_of(around)
        areas = with_land(areas, around, kind, ACTION, key, "edit/turf")
    if not sown.any() and not len(around):
        green = own.any() and areas["kind"].isin(GREEN).to_numpy()[own].all()
        why = "it is green already" if green else "there is no land for it"
        where = ", ".join(names) or "the place that is told"
        raise UsageError(f"No grass can be laid at {where}: {why}.")
    return renewed(city, replace(city.layout, areas=areas), surface=True)


def _key_of(land: NDArray[Any]) -> int:
    """Return a number for the place of some land, by which what lies there has ids of its own."""
    return stable_id(ACTION, *np.rint(10 * shapely.total_bounds(land)).astype(int).tolist())


def _around(city: City, ids: NDArray[np.uint64], reach: float) -> NDArray[Any]:
    """Return the land beside houses and streets, (k,) polygons."""
    layout = city.layout
    roads = np.isin(layout.roads["id"].to_numpy(np.uint64), ids)
    houses = layout.buildings.geometry.to_numpy()
    mine = np.isin(layout.buildings["id"].to_numpy(np.uint64), ids)
    near = [*shapely.buffer(houses[mine], reach), *ways_of(city, roads, reach)]
    return _free_land(city, np.array(near, object))


def with_land(
    areas: GeoDataFrame, land: NDArray[Any], kind: str, maker: str, key: int, source: str
) -> GeoDataFrame:
    """Return areas with new ones of a kind, whose ids come of who makes them and of a key."""
    number = hash_ids(0, maker, np.array([key], np.uint64), np.arange(len(land)))
    said = [f"{source}/{id_text(one)}" for one in number.tolist()]
    new = make_table("areas", land, id=number, kind=[kind] * len(land), source=said)
    return joined_tables(areas, new)


def land_around(city: City, shapes: NDArray[Any], reach: float) -> NDArray[Any]:
    """Return the free land of some ground and so many metres around it, (k,) polygons."""
    return _free_land(city, np.asarray(shapely.buffer(shapes, reach), object))


def _free_land(city: City, near: NDArray[Any]) -> NDArray[Any]:
    """Return what of some ground is no house, no way, no water and not green, (k,) polygons."""
    if not len(near):
        return np.zeros(0, object)
    layout = city.layout
    houses, roads = layout.buildings.geometry.to_numpy(), layout.roads
    wanted = shapely.union_all(near)
    areas = layout.areas
    other = areas["kind"].isin((*GREEN, *WET, "pedestrian", "parking", "road_area")).to_numpy()
    taken = np.array(
        [*houses, *ways_of(city, np.ones(len(roads), bool), 0.0), *areas.geometry[other]], object
    )
    taken = taken[shapely.intersects(taken, wanted)]
    free = shapely.difference(wanted, shapely.union_all(taken))
    parts = shapely.get_parts(shapely.intersection(free, shapely.box(*layout.extent)))
    return np.asarray(parts[(shapely.get_type_id(parts) == 3) & (shapely.area(parts) > LEAST)])
