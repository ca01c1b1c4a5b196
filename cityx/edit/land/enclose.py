"""Hedges, fences and walls along streets, around squares and around houses that exist."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.ground import ROADWAY
from cityx.city.layout import joined_tables, make_table
from cityx.edit.land.latest import LAID, latest
from cityx.edit.land.open_ground import ways_of
from cityx.edit.land.spots import CORNERS
from cityx.edit.renewal import renewed
from cityx.errors import UsageError
from cityx.geometry.polygons import region_of_corners
from cityx.ids import hash_ids, id_text, stable_id
from cityx.protocol import Choice, ObjectName, Points, Port, Range, Serves, action
from cityx.protocol.objects import find_objects
from cityx.sources.features.vocabulary import WATER_KINDS

ACTION = "edit/enclose-v1"
KINDS = ("hedge", "fence", "wall")
BEHIND = 0.6  # metres from the edge of a walk to the middle of a barrier
INSIDE = 0.8  # metres from the edge of an area
AROUND = 4.0  # metres from the walls of a house
HOUSES = 0.9  # metres from other houses, so that one gets by
TRUNKS = 0.6  # metres from trees, lamps and benches
GATE, GATES = 2.5, 40.0  # metres that are left open of a ring, so often along it
MOST_GATES = 20  # of one ring
WIDE = 0.4  # metres from the middle of a hedge to its side
PAVED = (*ROADWAY, "sidewalk", "frontage", "kerb", "furnishing", "edging", "path", "trail",
         "parking", "apron")  # fmt: skip
SHORTEST = 2.0  # metres of a piece that is worth building
STANDING = ("trees", "park_pieces", "street_furniture", "street_pieces")
Shapes = NDArray[Any]


@action(
    ACTION,
    limits=[
        "Ways, doors with a path, trees and houses interrupt it; a ring has a gate every 40 m "
        "unless so many are asked for.",
        "Along a street it stands behind the walk, where there is land.",
    ],
    requires=("layout",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    serves=tuple(
        Serves("edit=add", f"element={kind}", place, kind=kind)
        for kind in KINDS
        for place in ("beside", "within", "last")
    ),
    binds={
        "along": "beside",
        "near": "within",
        "height": "building.height",
        "gates": "gates",
        "last": "last",
        "part": "row.part",
    },
    labels=("hedge", "fence", "wall", "enclose", "hedgerow"),
)
def enclose(
    city: City,
    *,
    kind: Annotated[str, Choice(*KINDS)],
    along: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    near: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    last: Annotated[str | None, Choice(*LAID)] = None,
    height: Annotated[float | None, Range(0.3, 4.0)] = None,
    gates: Annotated[int | None, Range(0, MOST_GATES)] = None,
    part: Annotated[tuple[tuple[float, ...], ...] | None, Points(3, CORNERS)] = None,
) -> City:
    """Put a hedge, a fence or a wall along streets, or around areas and houses.

    Parameters
    ----------
    city
        City with its ground.
    kind
        What is put there.
    along, near
        Streets and paths, on both sides of which it runs, and areas and houses, around which it
        runs.
    last
        Kind of land, of which it runs around what was added last, instead.
    height
        Metres; usual for the kind when left out.
    gates
        Entrances of each ring, evenly spaced; one every `GATES` metres when left out.
    part
        Corners of polygons to which it keeps: x, y and which polygon.
    """
    names = (*(along or ()), *(near or ()))
    if not names and last is None:
        raise UsageError("Nothing is said of the place: a street, an area or a house.")
    ids = find_objects(city, names)
    own = _lines(city, ids)
    if last is not None:
        shape = shapely.buffer(latest(city, last), INSIDE)
        own = np.append(own, shapely.get_exterior_ring(shapely.get_parts(shape)))
    if not len(own):
        raise UsageError(f"A {kind} follows a street, an area or a house; {names[0]} is no such.")
    if part is not None:
        kept = shapely.get_parts(shapely.intersection(own, region_of_corners(part)))
        own = kept[shapely.length(kept) > 0]
    found = interrupted(city, own, ids, gates)
    if not len(found):
        raise UsageError(f"No {kind} finds room at {', '.join(names)}.")
    return put_up(city, kind, found, height)


def put_up(city: City, kind: str, found: Shapes, height: float | None) -> City:
    """Return the city with barriers of a kind along lines, (k,), of a usual height for None."""
    ends = np.rint(1000 * shapely.get_coordinates(shapely.line_interpolate_point(found, 0.0)))
    keys = [stable_id(ACTION, kind, *map(int, end)) for end in ends]
    number = hash_ids(0, ACTION, np.array(keys, np.uint64))
    table = make_table(
        "lines", found, id=number, kind=[kind] * len(found),
        source=[f"edit/{kind}/{id_text(one)}" for one in number.tolist()],
        height=np.full(len(found), np.nan if height is None else height),
    )  # fmt: skip
    lines = joined_tables(city.layout.lines, table)
    return renewed(city, replace(city.layout, lines=lines))


def _lines(city: City, ids: NDArray[np.uint64]) -> Shapes:
    """Return the lines that a barrier follows: both sides of ways, rings of areas and houses."""
    layout = city.layout
    own = {
        name: getattr(layout, name).geometry.to_numpy()[
            np.isin(getattr(layout, name)["id"].to_numpy(np.uint64), ids)
        ]
        for name in ("areas", "buildings")
    }
    ways = ways_of(city, np.isin(layout.roads["id"].to_numpy(np.uint64), ids), BEHIND)
    areas = layout.areas["kind"][np.isin(layout.areas["id"].to_numpy(np.uint64), ids)]
    inside = np.where(areas.isin(WATER_KINDS), -1.0, 1.0) * INSIDE
    inner = shapely.buffer(own["areas"], -inside, join_style="mitre")
    outer = shapely.buffer(own["buildings"], AROUND, join_style="mitre")
    whole = [shapely.union_all(each) for each in (ways, outer) if len(each)]
    shapes = shapely.get_parts(np.array([*whole, *inner], object))
    return np.asarray(shapely.get_exterior_ring(shapes[~shapely.is_empty(shapes)]))


def interrupted(
    city: City, lines: Shapes, ids: NDArray[np.uint64], entrances: int | None = None,
    paved: Sequence[str] = PAVED,
) -> Shapes:  # fmt: skip
    """Take ways, houses, waters and trees out of lines, and gates out of rings.

    Parameters
    ----------
    city
        The city.
    lines
        (n,) lines or rings.
    ids
        Of what they follow.
    entrances
        Of each ring; as many as usual when left out.
    paved
        Surfaces of the ground on which nothing is put.
    """
    layout = city.layout
    roads = layout.roads["id"].to_numpy(np.uint64)
    of_ways = np.isin(roads, ids).any()
    taken = [*ways_of(city, np.ones(len(roads), bool), BEHIND / 2)]
    taken += [*shapely.buffer(layout.buildings.geometry.to_numpy(), HOUSES)]
    areas = layout.areas
    wet = areas["kind"].isin(("water", "sea", "river", "pool")).to_numpy()
    taken += [*areas.geometry.to_numpy()[wet]]
    if city.ground is not None:
        hard = shapely.polygons(city.ground.vertices[city.ground.triangles_of(*paved)])
        near = shapely.STRtree(lines).query(hard, predicate="dwithin", distance=WIDE)[0]
        taken += [*shapely.buffer(hard[np.unique(near)], WIDE)]
    for layer in STANDING:
        rows = city.scene.instances.get(layer)
        if rows is not None:
            taken += [*shapely.buffer(shapely.points(rows.position[:, :2]), TRUNKS)]
    if not of_ways:
        for line in lines:
            whole = float(shapely.length(line))
            gates = np.arange(GATES / 2, whole, GATES)
            if entrances is not None:
                gates = (np.arange(entrances) + 0.5) * (whole / max(entrances, 1))
            taken += [*shapely.buffer(shapely.line_interpolate_point(line, gates), GATE / 2)]
    held = np.array(taken, object)
    near = shapely.STRtree(held).query(lines, predicate="intersects")
    found = [
        shapely.difference(line, shapely.union_all(held[near[1][near[0] == row]]))
        for row, line in enumerate(lines)
    ]
    site = shapely.box(*layout.extent)
    parts = shapely.get_parts(shapely.line_merge(shapely.intersection(np.array(found), site)))
    good = (shapely.get_type_id(parts) == 1) & (shapely.length(parts) >= SHORTEST)
    return np.asarray(parts[good])
