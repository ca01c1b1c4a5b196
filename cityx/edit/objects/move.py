"""Moving objects."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from cityx.city.city import City
from cityx.city.scene import Instances
from cityx.edit.buildings.resettling import reshaped
from cityx.edit.objects.footing import moved_pieces, moved_points
from cityx.edit.objects.settling import settled
from cityx.edit.targets import targets_of
from cityx.protocol import ObjectName, Port, Range, action
from cityx.protocol.serving import Serves

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
    serves=(Serves("edit=move", "offset"),),
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
