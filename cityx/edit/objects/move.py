"""Moving objects."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
import shapely

from cityx.city.city import City
from cityx.city.rows import take_rows
from cityx.city.scene import Instances
from cityx.edit.buildings.resettling import reshaped, room_for
from cityx.edit.land.room import faults, stand_of
from cityx.edit.objects.footing import moved_pieces, moved_points
from cityx.edit.objects.remove import FAMILIES
from cityx.edit.targets import Targets, targets_of
from cityx.geometry.arrays import FloatArray
from cityx.protocol import ObjectName, Port, Range, action
from cityx.protocol.serving import Serves

# Settling: the nearest place with room for what is to stand somewhere about.


STEP = 1.0  # metres between the places that are tried for things
WIDE = 3.0  # and for buildings


def settled(city: City, targets: Targets, way: FloatArray, reach: float) -> FloatArray:
    """Return how far objects are moved so that all find room, near to a way that is wanted.

    Parameters
    ----------
    city
        The city.
    targets
        What is moved.
    way
        (2,) metres.
    reach
        Metres from there that they may end.

    Returns
    -------
    way
        The one wanted, where there is no room at all: who moves it says why.
    """
    step = WIDE if len(targets.buildings) else STEP
    steps = np.arange(-reach, reach + step, step)
    off = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    far = np.hypot(*off.T)
    order = np.lexsort((off[:, 0], off[:, 1], np.round(far, 6)))
    ways = way + off[order[far[order] <= reach]]
    free = np.ones(len(ways), bool)
    if len(targets.buildings):
        table = city.layout.buildings
        own = np.isin(table["id"].to_numpy(np.uint64), targets.buildings)
        for shape in table.geometry.to_numpy()[own]:
            shapes = np.array(
                [shapely.transform(shape, lambda xy, w=each: xy + w) for each in ways], object
            )
            free &= room_for(city, shapes, targets.buildings)
    for rows in city.scene.instances.values():
        for at in np.flatnonzero(np.isin(rows.object_id, targets.pieces)).tolist():
            one = take_rows(rows, slice(at, at + 1))
            stand = stand_of(city.scene.prototypes[int(one.prototype[0])])
            spots = one.position[:, :2] + ways
            yaw = np.full(len(ways), float(one.rotation[0, 2]))
            why = faults(city, stand, spots, yaw, but=targets.pieces)
            free &= np.array([not text for text in why], bool)
    found = np.flatnonzero(free)
    return np.asarray(ways[found[0]] if len(found) else way)


FURTHEST = 100_000.0  # metres; nothing is moved farther than a city is large


@action(
    "edit/move-v1",
    limits=[
        "Things stay upright and stand on the ground of the new place.",
        "Refused where the new place is in a wall, on a carriageway or beyond the site.",
        "What has a track is moved with the whole of its track.",
    ],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("move", "shift", "drag", "relocate", "push"),
    serves=tuple(Serves("edit=move", "offset", f"family={family}") for family in FAMILIES),
    binds={"objects": "objects", "offset": "offset", "settle": "settle"},
)
def move(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    offset: Annotated[tuple[float, float], Range(-FURTHEST, FURTHEST)],
    settle: Annotated[float, Range(0.0, 200.0)] = 0.0,
    anywhere: bool = False,
) -> City:
    """Move objects, everything they own with them.

    Parameters
    ----------
    city
        The city.
    objects
        Buildings, and things that stand or move about.
    offset
        Metres to the east and to the north.
    settle
        Metres from there at which they may stand where there is no room: the nearest is taken.
    anywhere
        Whether things may be put where such things do not stand, as an artist may wish.
    """
    found = targets_of(city, objects)
    way = np.asarray(offset, float)
    if settle and not anywhere:
        way = settled(city, found, way, settle)
    if len(found.buildings):
        city = reshaped(city, found.buildings, lambda points: points + way)
    if len(found.pieces):
        city = moved_pieces(city, found.pieces, lambda rows: _shifted(rows, way), anywhere=anywhere)
        city = moved_points(city, found.pieces, way)
    if len(found.movers) and city.tracks is not None:
        tracks = city.tracks
        mine = np.isin(tracks.object_id, found.movers)[tracks.mover]
        position = tracks.position.copy()
        position[mine, :2] += way
        city = replace(city, tracks=replace(tracks, position=position))
    return city


def _shifted(rows: Instances, way: np.ndarray[tuple[int], np.dtype[np.float64]]) -> Instances:
    position = rows.position.copy()
    position[:, :2] += way
    return replace(rows, position=position)
