"""Trees planted in a city that exists: in rows beside ways, or scattered over a place."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.trees.species import OUTSIDE_TREES
from cityx.city import City
from cityx.city.rows import take_rows
from cityx.edit.land.latest import LAID, latest, ring_round
from cityx.edit.land.spots import CORNERS
from cityx.edit.land.waysides import Polygons, beside
from cityx.edit.objects.layer_rows import with_rows, without_rows
from cityx.errors import UsageError
from cityx.geometry.arrays import FloatArray
from cityx.geometry.clearance import near_any
from cityx.geometry.polygons import corners_of, region_of_corners
from cityx.geometry.scatter import Points, poisson_in
from cityx.ids import UInt64Array, hash_ids
from cityx.nature.furniture.furnishing import lamp_places
from cityx.nature.trees.stands import (
    INDEX,
    SPECIES,
    Stand,
    draw_species,
    rows_of,
    stand_of,
    take_trees,
)
from cityx.nature.trees.tree_pits import pits_of
from cityx.nature.trees.tree_room import KERB_CLEARANCE, SIGHT, Room, room_of
from cityx.protocol import Choice, ObjectName, Port, Range, Serves, action
from cityx.protocol import Points as Corners
from cityx.protocol.objects import find_objects

ACTION = "edit/plant-v1"

KINDS = tuple(name for name in SPECIES if name != "grove" and name not in OUTSIDE_TREES)
ROW_SPACING = 10.0  # metres between the trees of a row, where nothing is said
ROW_WIDTH = 3.0  # metres to both sides of a new row in which older trees make room for it
LEAST_GAP = 3.5  # metres from a scattered tree to the next
SPACINGS = (9.0, 7.0, 5.5, 4.5, LEAST_GAP)  # metres between scattered trees, tried in turn
THING_GAP = 1.2  # metres from a trunk to lamps, benches and all else that stands about
AMOUNTS = {"few": 3, "some": 8, "many": 25}  # trees, where no number is said
BANK = 8.0  # metres round land that was added last in which trees are scattered
SLIDES = (0.5, -0.5, 1.0, -1.0)  # metres along a row, tried in turn beside things
THINGS = ("street_furniture", "street_pieces", "park_pieces", "vehicles")


@action(
    ACTION,
    limits=[
        "Trees keep off carriageways, walls, waters and things; a row yields by 1 m, or has gaps.",
        "Older trees within 3 m of a new row make room for it.",
    ],
    requires=("layout",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("trees", "point", role="tree"),),
    serves=(Serves("edit=plant", "nature=tree"),),
    binds={
        "count": "count", "amount": "amount", "spacing": "spacing", "species": "species",
        "along": "beside", "within": "within", "ground": "ground",
        "last": "last", "part": "row.part",
    },
    labels=("plant", "trees", "avenue of trees", "greener"),
)  # fmt: skip
def plant(
    city: City,
    *,
    count: Annotated[int | None, Range(1, 20_000)] = None,
    amount: Annotated[str | None, Choice(*AMOUNTS)] = None,
    spacing: Annotated[float | None, Range(3.0, 200.0)] = None,
    species: Annotated[str | None, Choice(*KINDS, outside="cityx.species")] = None,
    along: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    within: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    ground: Annotated[tuple[tuple[float, ...], ...] | None, Corners(3, CORNERS)] = None,
    last: Annotated[str | None, Choice(*LAID)] = None,
    sides: Annotated[str, Choice("left", "right", "both")] = "both",
    part: Annotated[tuple[tuple[float, ...], ...] | None, Corners(3, CORNERS)] = None,
) -> City:
    """Plant trees in rows along ways or scattered within a place; everything else stays.

    Parameters
    ----------
    city
        City with its ground, if there is one.
    count
        Trees at most in a row, and exactly so many where they are scattered.
    amount
        How many, in a word, where no count is given.
    spacing
        Metres between the trees of a row.
    species
        Kind of tree; drawn for the climate when left out.
    along
        Streets, paths or areas beside which the row stands.
    within
        Areas over which trees are scattered, and objects around which they are; the whole site when
        left out.
    ground
        Corners of polygons over which they are scattered, instead: x, y and which polygon.
    last
        Kind of land, round what was added last of which they are scattered, instead.
    sides
        Of the ways, as they are drawn.
    part
        Corners of polygons to which a row keeps: x, y and which polygon.
    """
    if last is not None:
        ground = corners_of(ring_round(latest(city, last), BANK))
    if city.lod < 1:
        raise UsageError("A city of detail level 0 has no trees; build it at level 1 or above.")
    if along is not None:
        ids = find_objects(city, along)
        city, stand, room = _row(city, ids, spacing or ROW_SPACING, species, sides, part)
        if count is not None:
            stand, room = _first(stand, room, count)
        if not len(stand.id):
            raise UsageError(f"No tree finds room along {', '.join(along)}.")
    else:
        areas = _areas(city, within, ground)
        wanted = count if count is not None else AMOUNTS[amount or "some"]
        stand, room = _scattered(city, areas, wanted, species)
    prototypes, rows = rows_of(city, stand, room)
    city = replace(city, scene=with_rows(city.scene, "trees", prototypes, rows))
    return _with_pits(city, stand.id) if city.lod > 1 else city


def _with_pits(city: City, ids: UInt64Array) -> City:
    """Put pits under trees that stand on paving."""
    trees = city.scene.instances["trees"]
    found = pits_of(city, take_rows(trees, np.isin(trees.object_id, ids)))
    if found is None:
        return city
    prototypes, rows = found
    return replace(city, scene=with_rows(city.scene, "tree_pits", prototypes, rows))


def species_rows(city: City, name: str | None, ids: UInt64Array, street: bool) -> NDArray[np.int64]:
    """Return the rows of the table of kinds for trees: all of one kind, or drawn for each."""
    if name is not None:
        return np.full(len(ids), INDEX[name], np.int64)
    return draw_species("street" if street else "park", city, ids)


def _row(
    city: City, ids: UInt64Array, spacing: float, species: str | None, sides: str,
    part: Polygons | None,
) -> tuple[City, Stand, Room]:  # fmt: skip
    """Return a city without the trees in the way of a row, and the row; a street has one kind."""
    places = beside(city, ids, spacing=spacing, beyond=KERB_CLEARANCE + 0.1, margin=SIGHT / 2,
                    sides=sides, part=part)  # fmt: skip
    own = hash_ids(0, f"{ACTION}/row", places.line, places.number)
    held = city.scene.instances.get("trees")
    if held is not None and len(own):
        near = near_any(held.position[:, :2], shapely.points(places.xy), ROW_WIDTH)
        city = replace(city, scene=without_rows(city.scene, "trees", held.object_id[near]))
    key = np.full(len(own), ids.min() if len(ids) else 0, np.uint64)
    xy = _past_things(places.xy, places.toward, _things(city))
    stand = stand_of(Points(xy, own), species_rows(city, species, key, street=True),
                     line=places.line, place=places.number)  # fmt: skip
    # Whoever plants a row knows the place: walls may be as near as to a tree of the map. Along the
    # streets of a whole town trees stand where their crowns have room.
    known = 2 * len(ids) <= len(city.layout.roads)
    return city, *_standing(city, stand, mapped=known)


def _past_things(xy: FloatArray, toward: FloatArray, things: FloatArray) -> FloatArray:
    """Move places along a row by the first of `SLIDES` at which nothing stands in the way."""
    xy, solid = xy.copy(), shapely.points(things)
    along = np.column_stack([-toward[:, 1], toward[:, 0]])
    taken = np.flatnonzero(near_any(xy, solid, THING_GAP))
    for step in SLIDES:
        tried = xy[taken] + step * along[taken]
        free = ~near_any(tried, solid, THING_GAP)
        xy[taken[free]] = tried[free]
        taken = taken[~free]
    return xy


def _areas(
    city: City, within: tuple[str, ...] | None, ground: tuple[tuple[float, ...], ...] | None
) -> NDArray[np.object_]:
    if ground is not None:
        return np.asarray(shapely.get_parts(region_of_corners(ground)), object)
    if within is None:
        return np.array([shapely.box(*city.layout.extent)], object)
    areas = city.layout.areas
    rows = np.isin(areas["id"].to_numpy(np.uint64), find_objects(city, within))
    if not rows.any():
        raise UsageError(f"Trees are planted within parks and other areas, no {', '.join(within)}.")
    return np.asarray(areas.geometry.to_numpy()[rows], object)


def _scattered(
    city: City, areas: NDArray[np.object_], count: int, species: str | None
) -> tuple[Stand, Room]:
    """Return so many trees on the open ground of some areas, clear of those there are."""
    held = city.scene.instances.get("trees")
    have = np.zeros((0, 2)) if held is None else held.position[:, :2]
    most = 0
    for spacing in SPACINGS:
        points = poisson_in(areas, spacing, seed=city.seed, purpose=ACTION,
                            bounds=city.layout.extent)  # fmt: skip
        ids = hash_ids(0, ACTION, points.id)
        clear = ~near_any(points.xy, shapely.points(have), max(spacing / 2, LEAST_GAP))
        points = Points(points.xy[clear], ids[clear])
        stand = stand_of(points, species_rows(city, species, points.id, street=False))
        stand, room = _standing(city, stand, mapped=False)
        most = max(most, len(stand.id))
        if len(stand.id) >= count:
            return _first(stand, room, count)
    raise UsageError(f"There is room for {most} more trees there, {count} are asked for.")


def _standing(city: City, stand: Stand, *, mapped: bool) -> tuple[Stand, Room]:
    """Return the trees that find room, with what surrounds them."""
    xmin, ymin, xmax, ymax = city.layout.extent
    x, y = stand.xy.T
    inside = (x > xmin) & (x < xmax) & (y > ymin) & (y < ymax)
    inside &= ~near_any(stand.xy, shapely.points(_things(city)), THING_GAP)
    stand = take_trees(stand, inside)
    # A row keeps its rhythm, so its trees are not moved out of what is in their way.
    xy, free, room = room_of(city, stand.xy, np.full(len(stand.id), mapped), lamp_places(city))
    free &= np.hypot(*(xy - stand.xy).T) < 1e-9
    return take_trees(stand, free), Room(room.facade[free], room.road[free], room.path[free])


def _things(city: City) -> FloatArray:
    """(m, 2) where anything stands that a trunk must leave room for."""
    found = [np.zeros((0, 2))]
    for layer in THINGS:
        rows = city.scene.instances.get(layer)
        found.append(np.zeros((0, 2)) if rows is None else rows.position[:, :2])
    return np.concatenate(found)


def _first(stand: Stand, room: Room, count: int) -> tuple[Stand, Room]:
    """Return so many of the trees, those whose ids come first."""
    chosen = np.sort(np.argsort(stand.id, kind="stable")[:count])
    return take_trees(stand, chosen), Room(
        room.facade[chosen], room.road[chosen], room.path[chosen]
    )
