"""Adding things that stand about."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Annotated

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.furniture.outside_pieces import GROUP
from cityx.assets.furniture.street_furniture import MAKERS, VARIANTS, furniture
from cityx.building.splicing import with_rows
from cityx.city.city import City
from cityx.city.layout import ASKED_KINDS
from cityx.city.scene import Instances
from cityx.edit.land.latest import LAID, latest, ring_round
from cityx.edit.land.room import Stand, faults, refuse, stand_of
from cityx.edit.land.spots import (
    CORNERS,
    ROWS,
    facing,
    region_around,
    spots_beyond,
    spots_in,
    spots_within,
    turned_to,
)
from cityx.errors import ActionFailed
from cityx.geometry.polygons import polygons_of_corners, region_of_corners
from cityx.geometry.turns import SIDES
from cityx.ground.pieces import heights
from cityx.ids import stable_id, uniform
from cityx.protocol import Choice, ObjectName, Points, Port, Range, action
from cityx.protocol.serving import Serves

LAYER = "street_pieces"
MOST = 500  # things that one call adds
PLACES = ("within", "from", "ground", "last")  # slots that tell where
RING = 4.0  # metres round land or a building that was added last
BY = 6.0  # metres round what was added last, in which something is put by it
# Things that stand on ground of their own; `edit/add_element` builds them.
LARGE = (
    "ferris_wheel",
    "carousel",
    "circus_tent",
    "radio_mast",
    "triumphal_arch",
    "obelisk",
    "war_memorial",
    "market_cross",
    "bandstand",
    "amphitheatre",
    "excavator",
    "stage",
    "hot_air_balloon",
    "bouncy_castle",
    "helicopter",
)
# Word for a thing -> its prototype.
WORDS: Mapping[str, str] = MappingProxyType(
    {
        "bench": "bench", "fountain": "fountain", "statue": "statue",
        "streetlight": "street_lamp_post", "traffic_light": "traffic_signal",
        "billboard": "billboard", "flower": "planter", "bus": "bus",
        "waste_basket": "waste_basket", "bollard": "bollard", "planter": "planter",
        "bicycle_stand": "bicycle_parking", "bus_stop": "bus_stop", "kiosk": "kiosk",
        "picnic_table": "picnic_table", "hydrant": "fire_hydrant", "flagpole": "flagpole",
        "post_box": "post_box", "parasol": "parasol", "cone": "traffic_cone",
        "boulder": "rock", "vending_machine": "vending_machine", "phone_box": "telephone",
        "advertising_column": "advertising_column",
        **{kind: kind for kind in ASKED_KINDS if kind not in (*LARGE, "rock")},
    }
)  # fmt: skip


@action(
    "edit/add-v1",
    limits=[
        "Nothing is put into walls, water, carriageways or other things.",
        "Where there is room for fewer than are asked for, none is added.",
    ],
    takes=(Port("place", "point"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("add", "place", "put", "bench", "fountain", "statue", "lamp"),
    serves=tuple(
        Serves("edit=add", f"element={word}", place, thing=name)
        for word, name in WORDS.items()
        for place in PLACES
    )
    + tuple(Serves("edit=add", "outside_thing", place) for place in PLACES),
    binds={
        "thing": "outside_thing",
        "within": "within",
        "ground": "ground",
        "last": "last",
        "count": "count",
        "beyond": "from",
        "side": "side",
        "off": "off",
        "row": "row",
        "each": "each",
        "toward": "toward",
    },
)
def add(
    city: City,
    *,
    thing: Annotated[str, Choice(*sorted(MAKERS), outside=GROUP)],
    at: Annotated[tuple[tuple[float, ...], ...] | None, Points(1, MOST)] = None,
    within: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    ground: Annotated[tuple[tuple[float, ...], ...] | None, Points(3, CORNERS)] = None,
    last: Annotated[str | None, Choice(*WORDS, *LAID)] = None,
    beyond: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    side: Annotated[str, Choice(*SIDES)] = "south",
    off: Annotated[float | None, Range(0.0, 500.0)] = None,
    count: Annotated[int, Range(1, MOST)] = 1,
    row: Annotated[str | None, Choice(*ROWS)] = None,
    each: Annotated[str | None, Choice("yes")] = None,
    angle: Annotated[float | None, Range(-2 * np.pi, 2 * np.pi)] = None,
    toward: Annotated[tuple[str, ...] | None, ObjectName()] = None,
) -> City:
    """Add things that stand about: benches, lamps, a fountain.

    Parameters
    ----------
    city
        The city.
    thing
        Name of its prototype.
    at
        Where they stand, scene frame, metres; one for each.
    within
        Squares and parks that they stand in, or objects that they stand near, instead.
    ground
        Corners of the polygons that they stand in, instead: x, y and which polygon.
    last
        Kind of thing of which they stand round the only one that was added, or of land of which
        they stand round what was added last, instead.
    beyond
        Objects that they stand beyond a side of, instead.
    side
        Which side, where they do.
    off
        Metres from the edge there to their middle; as near as there is room when left out.
    count
        How many, where no places are given.
    row
        Where each stands from the one before, looking as that does; anywhere when left out.
    each
        "yes" for so many in each of the polygons or round each of the objects.
    angle
        Radians counter-clockwise by which their front is turned from the south; towards the nearest
        way when left out.
    toward
        Objects that they face, instead.
    """
    prototype = furniture(thing, detail=city.lod)
    stand = stand_of(prototype)
    if at is not None:
        xy = np.array([point[:2] for point in at], float)
    elif each and within is not None:
        xy = _in_each([region_around(city, [one]) for one in within], city, count, stand)
    elif within is not None:
        xy = spots_within(city, within, count, stand, row=row or "")
    elif each and ground is not None:
        xy = _in_each(polygons_of_corners(ground), city, count, stand)
    elif ground is not None:
        xy = spots_in(city, region_of_corners(ground), count, stand, row=row or "")
    elif last is not None:
        reach = float(max(stand.size)) + (RING if last in LAID else BY)
        xy = spots_in(city, round_last(city, last, reach), count, stand, row=row or "")
    elif beyond is not None:
        xy = spots_beyond(city, beyond, side, off, count, stand, row=row or "")
    else:
        raise ActionFailed("Nothing is said of the place: points, or what they are to be in.")
    if angle is not None:
        yaw = np.array([angle])
    elif toward is not None:
        yaw = turned_to(city, xy, toward)
    else:
        yaw = facing(city, xy[:1] if row else xy)
    yaw = np.broadcast_to(yaw, len(xy)) if len(yaw) == 1 else yaw
    for place, why in enumerate(faults(city, stand, xy, yaw, but=np.zeros(0, np.uint64))):
        if why:
            none = np.zeros(0, np.uint64)
            refuse(city, stand, xy[place], float(yaw[place]), why, but=none)
    rows = _rows(city, thing, xy, yaw)
    taken = np.isin(rows.object_id, _known(city))
    if taken.any():
        spot = xy[np.flatnonzero(taken)[0]]
        raise ActionFailed(f"A {thing.replace('_', ' ')} stands at {spot[0]:.1f}, {spot[1]:.1f}.")
    return _with(city, rows, thing)


def _in_each(
    regions: Sequence[shapely.Geometry], city: City, count: int, stand: Stand
) -> NDArray[np.float64]:
    """Return places for so many things in each of some regions, (n, 2).

    Raises
    ------
    ActionFailed
        If one of the regions has no room.
    """
    if count * len(regions) > MOST:
        raise ActionFailed(f"{count} at each of {len(regions)} places are more than {MOST}.")
    found: list[NDArray[np.float64]] = []
    for number, region in enumerate(regions):
        try:
            found.append(spots_in(city, region, count, stand))
        except ActionFailed as error:
            x, y = shapely.get_coordinates(region.centroid)[0]
            said = f"At place {number + 1} of {len(regions)} ({x:.0f}, {y:.0f}): {error}"
            raise ActionFailed(said) from error
    return np.concatenate(found)


def round_last(city: City, word: str, reach: float) -> shapely.Geometry:
    """Return the ground so many metres round what was added last of a kind.

    Raises
    ------
    ActionFailed
        If none was added, or several things.
    """
    if word in LAID:
        return ring_round(latest(city, word), reach)
    rows = city.scene.instances.get(LAYER)
    names = [prototype.name for prototype in city.scene.prototypes]
    found: list[int] = []
    thing = WORDS[word]
    for at in range(rows.count if rows is not None else 0):
        assert rows is not None
        kind = names[rows.prototype[at]]
        if kind in VARIANTS.get(thing, (thing,)) and (
            _id_of(thing, rows.position[at, :2]) == rows.object_id[at]
        ):
            found.append(at)
    if rows is None or len(found) != 1:
        said = word.replace("_", " ")
        raise ActionFailed(f"{len(found)} {said} were added by commands; which is meant? Name it.")
    wide = float(np.hypot(*stand_of(city.scene.prototypes[rows.prototype[found[-1]]]).size)) / 2
    return shapely.Point(*rows.position[found[-1], :2].tolist()).buffer(wide + reach)


def _id_of(thing: str, place: NDArray[np.float64]) -> int:
    """Return the id of a thing that was put at a place by a command."""
    return stable_id("edit/add", thing, *np.rint(1000 * place).astype(np.int64).tolist())


def _with(city: City, rows: Instances, thing: str) -> City:
    from dataclasses import replace

    looks = [furniture(name, detail=city.lod) for name in VARIANTS.get(thing, (thing,))]
    return replace(city, scene=with_rows(city.scene, LAYER, looks, rows))


def _known(city: City) -> NDArray[np.uint64]:
    rows = city.scene.instances.get(LAYER)
    return rows.object_id if rows is not None else np.zeros(0, np.uint64)


def _rows(city: City, thing: str, xy: NDArray[np.float64], yaw: NDArray[np.float64]) -> Instances:
    """Return rows of things; each is known by what it is and where it was put."""
    number = len(xy)
    ids = np.array([_id_of(thing, place) for place in xy], np.uint64)
    looks = len(VARIANTS.get(thing, (thing,)))
    look = (uniform(city.seed, "edit/add/look", ids) * looks).astype(np.int32)
    rotation = np.zeros((number, 3), np.float32)
    rotation[:, 2] = yaw
    return Instances(
        look, ids, np.zeros(number, np.uint64),
        np.column_stack([xy, heights(city, xy)]), rotation,
        np.ones((number, 3), np.float32), np.ones((number, 3), np.float32),
    )  # fmt: skip
