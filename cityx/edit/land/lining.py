"""Rows of lamps, benches, bins or bollards beside streets and paths that exist."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
import shapely

from cityx.assets.furniture.outside_pieces import GROUP
from cityx.assets.furniture.street_furniture import furniture, outside_pieces
from cityx.city import City, Instances
from cityx.edit.land.spots import CORNERS, turned_to
from cityx.edit.land.waysides import Polygons, Wayside, beside
from cityx.edit.objects.layer_rows import with_rows, without_rows
from cityx.errors import UsageError
from cityx.geometry.arrays import BoolArray
from cityx.geometry.clearance import near_any
from cityx.ground.pieces import Pieces, heights, inside_extent, may_stand, pieces
from cityx.ids import UInt64Array, hash_ids
from cityx.nature.furniture.furnishing import LAMP_SETBACK, MAIN
from cityx.protocol import Choice, ObjectName, Points, Port, Range, Serves, action
from cityx.protocol.objects import find_objects
from cityx.road.surface.kerbs import yaw_facing

ACTION = "edit/line-v1"
# Word -> prototype, metres from the kerb, usual spacing, and metres to trunks and other things.
THINGS = {
    "streetlight": ("street_lamp_post", LAMP_SETBACK, 30.0, 1.0),
    "bench": ("bench", 0.9, 25.0, 1.4), "waste_basket": ("waste_basket", 0.6, 40.0, 0.8),
    "bollard": ("bollard", 0.4, 2.0, 0.6), "planter": ("planter", 0.8, 12.0, 1.4),
    "bicycle_stand": ("bicycle_parking", 1.2, 60.0, 2.0),
    "billboard": ("billboard", 3.2, 60.0, 3.4),
    "security_camera": ("security_camera", 0.6, 40.0, 0.6),
    "speed_camera": ("speed_camera", 0.8, 150.0, 0.8),
    "parking_meter": ("parking_meter", 0.5, 12.0, 0.6),
    "charging_station": ("charging_station", 0.6, 15.0, 0.9),
    "drinking_fountain": ("drinking_fountain", 0.8, 80.0, 0.9),
    "cash_machine": ("cash_machine", 0.9, 100.0, 0.9), "park_board": ("park_board", 0.8, 60.0, 1.0),
    "totem_sign": ("totem_sign", 1.2, 60.0, 1.2), "kiosk": ("kiosk", 1.6, 60.0, 2.2),
    "jersey_barrier": ("jersey_barrier", 0.6, 3.2, 1.6),
    "post_box": ("post_box", 0.6, 80.0, 0.8), "hydrant": ("fire_hydrant", 0.6, 80.0, 0.8),
    "flagpole": ("flagpole", 0.7, 20.0, 0.8), "cone": ("traffic_cone", 0.4, 3.0, 0.5),
}  # fmt: skip
AMOUNTS = {"few": 3, "some": 6, "many": 5000}  # "many" is a row without a gap
MAST = "street_lamp_mast"  # a lamp of a main street
LAYER = "street_furniture"
LAMPS = "street_lamp"  # first words of the prototypes of lamps
LAMP_ROW = 4.0  # metres to both sides of a new row in which older lamps make room for it
FACADE = 0.4  # metres
JUNCTION = 1.0  # metres kept free behind junctions
SHIFTS = (0.0, 0.2, -0.2, 0.35, -0.35)  # of the spacing, by which a thing gives way to others
STANDING = ("trees", "street_furniture", "street_pieces", "park_pieces")


@action(
    ACTION,
    limits=[
        "What stands in the way of a thing moves it along by a third of the spacing at most; else "
        "it is left out.",
        "Older lamps beside the way make room for new ones.",
    ],
    requires=("layout",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("furniture", "point", role="street_furniture"),),
    serves=(
        *(Serves("edit=add", f"element={word}", "beside", thing=word) for word in THINGS),
        Serves("edit=add", "outside_thing", "beside"),
    ),
    binds={
        "thing": "outside_thing", "along": "beside", "spacing": "spacing", "count": "count",
        "amount": "amount", "part": "row.part", "toward": "toward",
    },
    labels=("street lamps", "benches", "bollards", "line the street"),
)  # fmt: skip
def line(
    city: City,
    *,
    thing: Annotated[str, Choice(*THINGS, outside=GROUP)],
    along: Annotated[tuple[str, ...], ObjectName()],
    spacing: Annotated[float | None, Range(1.5, 500.0)] = None,
    count: Annotated[int | None, Range(1, 5000)] = None,
    amount: Annotated[str | None, Choice(*AMOUNTS)] = None,
    sides: Annotated[str, Choice("left", "right", "both")] = "both",
    part: Annotated[tuple[tuple[float, ...], ...] | None, Points(3, CORNERS)] = None,
    toward: Annotated[tuple[str, ...] | None, ObjectName()] = None,
) -> City:
    """Line ways with things that face them, at a regular spacing.

    Parameters
    ----------
    city
        City with its ground.
    thing
        What is put there.
    along
        Streets, paths or areas.
    spacing
        Metres between them on each side; usual for the thing when left out.
    count
        How many, if there is room.
    amount
        The same in a word, where no count is given.
    sides
        Of the ways, as they are drawn.
    part
        Corners of polygons to which the row keeps: x, y and which polygon.
    toward
        Objects that the things face; the way when left out.
    """
    if city.lod < 1:
        raise UsageError("A city of detail level 0 has no lamps; build it at level 1 or above.")
    ids = find_objects(city, along)
    lamps = thing == "streetlight"
    found, cleared = _placed(city, thing, ids, spacing, sides, part)
    if toward is not None and len(found):
        found = replace(found, yaw=turned_to(city, found.xy, toward))
    if count is None and amount is not None:
        count = AMOUNTS[amount]
    if count is not None:
        found = found.take(np.sort(np.argsort(found.id, kind="stable")[:count]))
    if not len(found):
        raise UsageError(f"No {thing.replace('_', ' ')} finds room along {', '.join(along)}.")
    if lamps:
        city = cleared
    return _with_pieces(city, found)


def _placed(
    city: City, thing: str, ids: UInt64Array, spacing: float | None, sides: str,
    part: Polygons | None,
) -> tuple[Pieces, City]:  # fmt: skip
    """Return a row that fits in, and the city without the lamps that it takes the place of."""
    if thing in THINGS:
        name, setback, usual, gap = THINGS[thing]
    else:
        made = outside_pieces()[thing]
        name, setback, usual, gap = made.name, made.from_kerb, made.spacing, made.apart
    step = spacing or usual
    places = beside(
        city, ids, spacing=step, beyond=setback, margin=JUNCTION, sides=sides, part=part
    )
    own = hash_ids(0, f"{ACTION}/{thing}", places.line, places.number)
    roads = city.layout.roads
    main = np.isin(roads["kind"].to_numpy().astype(str), MAIN)
    main &= np.isin(roads["id"].to_numpy(np.uint64), ids)
    if thing == "streetlight":
        city = _without_lamps(city, places)
        name = MAST if main.any() else name
    ahead = np.column_stack([places.toward[:, 1], -places.toward[:, 0]])
    xy, left = places.xy.copy(), np.ones(len(own), bool)
    yaw = yaw_facing(places.toward)
    for shift in SHIFTS:
        spots = pieces(name, places.xy + shift * step * ahead, own, yaw)
        free = left & _free(city, spots, gap)
        xy[free] = spots.xy[free]
        left &= ~free
    return pieces(name, xy, own, yaw).take(~left), city


def _without_lamps(city: City, places: Wayside) -> City:
    """Take out the lamps at and between the places of a row."""
    held = city.scene.instances.get(LAYER)
    if held is None or not len(places.xy):
        return city
    lamp = np.array([p.name.startswith(LAMPS) for p in city.scene.prototypes])[held.prototype]
    next_to = places.line[1:] == places.line[:-1]
    between = shapely.linestrings(np.stack([places.xy[:-1], places.xy[1:]], axis=1)[next_to])
    row = np.concatenate([shapely.points(places.xy), between])
    gone = lamp & near_any(held.position[:, :2], row, LAMP_ROW)
    return replace(city, scene=without_rows(city.scene, LAYER, held.object_id[gone]))


def _free(city: City, found: Pieces, gap: float) -> BoolArray:
    """(n,) whether things stand clear of carriageways, walls and each other."""
    free = inside_extent(city, found.xy, 0.5) & may_stand(city, found)
    free &= ~near_any(found.xy, city.layout.buildings.geometry.to_numpy(), FACADE)
    for layer in STANDING:
        rows = city.scene.instances.get(layer)
        if rows is not None:
            free &= ~near_any(found.xy, shapely.points(rows.position[:, :2]), gap)
    return np.asarray(free)


def _with_pieces(city: City, found: Pieces) -> City:
    total = len(found)
    names, number = np.unique(found.name.astype(str), return_inverse=True)
    rotation = np.zeros((total, 3), np.float32)
    rotation[:, 2] = found.yaw
    rows = Instances(
        number.astype(np.int32), found.id, np.zeros(total, np.uint64),
        np.column_stack([found.xy, heights(city, found.xy)]), rotation,
        np.ones((total, 3), np.float32), np.ones((total, 3), np.float32),
    )  # fmt: skip
    prototypes = [furniture(str(name), detail=city.lod) for name in names]
    held = city.scene.instances.get(LAYER)
    scene = city.scene
    if held is not None:  # the same row once more takes the place of itself
        scene = without_rows(scene, LAYER, found.id)
    return replace(city, scene=with_rows(scene, LAYER, prototypes, rows))
