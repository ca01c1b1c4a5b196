"""Vehicles that stand: parked at the kerb, beside parked ones or on a car park, or in a queue."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.shapes import moved, prototype
from cityx.assets.vehicles.movers import looks_named, paints_of, size_of, vehicle
from cityx.building.splicing import with_rows
from cityx.city import City
from cityx.city.ground import ON_ROADWAY, ROADWAY
from cityx.city.lanes import MOVEMENTS, LaneGraph
from cityx.city.moments import moments_of
from cityx.city.scene import Instances, Prototype
from cityx.city.section import KIND
from cityx.city.thing_outlines import FURNITURE, placed_outlines
from cityx.edit.land.spots import CORNERS
from cityx.edit.life.places import Corners, ground_of
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import every, locate, to_linestrings
from cityx.ground.pieces import heights
from cityx.ids import choose, hash_ids, stable_id, uniform
from cityx.motion.feasible import ground_height
from cityx.places.profiles import profile_of
from cityx.protocol import Choice, ObjectName, Points, Port, Range, Serves, action, has_network
from cityx.protocol.objects import find_objects
from cityx.road.network.lane_graph import lanes
from cityx.road.network.sections import bands_of
from cityx.road.parking.bays import join_bays, lot_bays, yard_bays
from cityx.road.parking.kerb_bays import free_of

ACTION = "dynamic/stopped_vehicles-v1"
LAYER = "stopped_vehicles"
KINDS = ("car", "van", "truck", "bus", "motorcycle", "taxi", "police", "ambulance", "fire_engine",
         "snow_plough")  # fmt: skip
PARK, DOUBLE, QUEUE = "park", "double_park", "queue"
MOST = 500
USUAL = 8  # vehicles that nobody counted, where there is room for so many
KERB = 0.22  # metres from the kerb to the side of a vehicle
BESIDE = 0.45  # metres from parked vehicles to one beside them
STEP = 1.5  # metres between the places that are looked at
APART = 0.6  # metres to the next vehicle in front and behind
PASSING = 0.25  # metres kept to what drives by
EVERY = 0.5  # seconds between the moments at which it is looked what drives by
AROUND = 25.0  # metres from a stop, a shop or a crossing to a vehicle that stands at it
ROADSIDE = 12.0  # metres from squares and parks to vehicles at them
ROW = 1.0  # metres from a kerb without a lane for parking to who stands in the second row there
HALT = 1.2  # metres from the end of a lane to the front of the first vehicle of a queue
BEHIND = 2.2  # metres from one vehicle of a queue to the next
UPSTREAM = 5  # lanes of a queue, one behind the other
TOGETHER = 35.0  # metres between the fronts of queues that stand before one junction
LONG = 40.0  # metres of a queue whose vehicles nobody counted, on each lane


@action(
    ACTION,
    limits=[
        "They stand where nothing that moves already passes; traffic that is made later does not "
        "know of them.",
        "Where there is room for fewer than are asked for, none is added.",
        "A queue stands in the lanes: vehicles that drove through it before are taken away.",
    ],
    requires=("layout", has_network()),
    takes=(Port("place", "point", optional=True),),
    gives=(Port("vehicles", "point", role="vehicle"),),
    labels=(
        "parked",
        "double-parked",
        "delivery van",
        "taxi rank",
        "ambulance",
        "police car",
        "queue",
        "traffic jam",
    ),
    serves=(
        *(
            Serves("edit=add_agent", f"agent={kind}", f"mode={how}", kind=kind, how=how)
            for kind in KINDS
            for how in (PARK, DOUBLE, QUEUE)
        ),
        Serves("edit=add_agent", "agent=vehicle", f"mode={QUEUE}", how=QUEUE),
    ),
    binds={"within": "at", "ground": "ground", "count": "count", "each": "each"},
)
def stopped_vehicles(
    city: City,
    *,
    kind: Annotated[str, Choice(*KINDS)] = "car",
    count: Annotated[int | None, Range(1, MOST)] = None,
    how: Annotated[str, Choice(PARK, DOUBLE, QUEUE)] = PARK,
    within: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    ground: Annotated[Corners | None, Points(3, CORNERS)] = None,
    each: Annotated[str | None, Choice("yes")] = None,
) -> City:
    """Let vehicles stand at the kerb, beside parked ones, or in the bays of car parks.

    Parameters
    ----------
    city
        City with a road network.
    kind
        Of vehicle.
    count
        How many; None for as many as there is room for, eight at most, or for a queue of 40 m.
    how
        At the kerb or in a bay; double-parked, in the roadway beside the row at the kerb; or in a
        queue, one behind the other in the lanes that lead to the place.
    within
        Streets and car parks on which they stand, or things and buildings near which; anywhere when
        left out.
    ground
        Corners of ground near which they stand besides, (x, y, number of the polygon).
    each
        "yes" for so many at every one of them.
    """
    if each and within is not None:
        for name in within:
            city = stopped_vehicles(city, kind=kind, count=count, how=how, within=(name,))
        return city
    wanted = count or USUAL
    looks = _looks(city, kind, MOST if how == QUEUE and count is None else wanted)
    size = np.array([size_of(look)[:2] for look in looks]).max(axis=0)
    if how == QUEUE:
        return _queued(city, within, ground, looks, size, count, kind)
    xy, heading, lane = _candidates(city, within, ground, size, how)
    if not len(xy):
        raise ActionFailed(f"No {kind} can stand there: there is no kerb and no car park.")
    free = _free(city, xy, heading, size, _moving(city))
    chosen = _spread(city, xy[free], heading[free], lane[free], wanted, size)
    if len(chosen) < (count or 1):
        raise ActionFailed(f"There is room for {len(chosen)} of {wanted} there.")
    rows = np.flatnonzero(free)[chosen]
    xy, heading = xy[rows], heading[rows]
    return _with(city, looks[: len(rows)], xy, heading, kind, heights(city, xy))


def _queued(
    city: City, names: tuple[str, ...] | None, ground: Corners | None, looks: list[str],
    size: FloatArray, count: int | None, kind: str,
) -> City:  # fmt: skip
    """Let vehicles stand one behind the other in the lanes that lead to a place."""
    city = city if city.lanes is not None else lanes(city)
    xy, heading, number, front = _in_line(city, names, ground, float(size[0]))
    if not len(xy):
        raise ActionFailed(f"No {kind} can queue there: no lane leads to it.")
    free = _free(city, xy, heading, size, _moving(city, on_foot=True))
    xy, heading, number, front = xy[free], heading[free], number[free], front[free]
    far = np.hypot(*(front - np.array(city.layout.extent).reshape(2, 2).mean(axis=0)).T)
    first = front[np.argmin(np.round(far, 2))] if len(far) else np.zeros(2)
    away = np.hypot(*(front - first).T) > TOGETHER  # from the queues before one junction
    long = number * (size[0] + BEHIND) < LONG
    most = count or int((long & ~away).sum())
    order = np.lexsort((xy[:, 1], xy[:, 0], number, np.round(far * away), away))
    boxes = _boxes(xy, heading, size, np.array([APART / 2, -0.1]))
    taken: list[int] = []
    for row in order.tolist():
        if len(taken) == most:
            break
        if not shapely.intersects(boxes[taken], boxes[row]).any():
            taken.append(row)
    if len(taken) < (count or 1):
        raise ActionFailed(f"There is room for {len(taken)} of {count or 1} in a queue there.")
    xy, heading = xy[taken], heading[taken]
    stood = _with(city, looks[: len(taken)], xy, heading, kind, ground_height(city, xy))
    return _without_passing(stood, _boxes(xy, heading, size, np.array([PASSING, PASSING])))


def _in_line(
    city: City, names: tuple[str, ...] | None, ground: Corners | None, length: float
) -> tuple[FloatArray, FloatArray, IntArray, FloatArray]:
    """Return places in lanes, (n, 2), headings, (n,) radians, numbers in queues and their fronts.

    A queue ends where the lane does if that is at the place, else where the lane leaves the place.
    """
    graph, network = city.lanes, city.network
    assert graph is not None
    assert network is not None
    table = city.layout.roads.iloc[network.edge_road]
    driven = table["kind"].isin((*_DRIVEN, "motorway")).to_numpy()
    open_ = ~(table["tunnel"] | table["passage"]).to_numpy(bool)
    own = (graph.kind == KIND["drive"]) & graph.travelled & (driven & open_)[graph.edge]
    lines = to_linestrings(graph.lines)
    end = shapely.length(lines)
    named = np.isin(table["id"].to_numpy(np.uint64), find_objects(city, names or ()))[graph.edge]
    place = None if named.any() else _near(city, names, ground)
    own &= named | ~named.any()
    if place is not None:
        shapely.prepare(place)
        own &= shapely.intersects(place, lines)
        lead = own & shapely.intersects(place, shapely.get_point(lines, -1))
        own = lead if lead.any() else own
        passing = np.flatnonzero(own & ~lead)
        end[passing] = [_last(line, place) for line in lines[passing]]
    lane, number, front = _filled(graph, own, end, length + BEHIND, length)
    along = end[lane] - HALT - length / 2 - number[1] * (length + BEHIND)
    xy, onward = locate(graph.lines, lane, along)
    fronts = locate(graph.lines, front, end[front])[0]
    return xy, np.arctan2(onward[:, 1], onward[:, 0]), number[0], fronts


def _filled(
    graph: LaneGraph, own: NDArray[np.bool_], end: FloatArray, step: float, length: float
) -> tuple[IntArray, IntArray, IntArray]:
    """Return lanes of (n,) vehicles, (2, n) numbers in queue and in lane, and the foremost lanes.

    A queue that fills its lane goes on in the lane that leads straight into it.
    """
    room = np.maximum((end - HALT - length) // step + 1, 0).astype(np.int64)
    into = graph.connection[graph.movement == MOVEMENTS.index("through")]
    straight = dict(zip(into[::-1, 1].tolist(), into[::-1, 0].tolist(), strict=True))
    used = set(np.flatnonzero(own).tolist())
    found = []
    for first in sorted(used):
        lane, told = first, 0
        for _ in range(UPSTREAM):
            found += [(lane, told + k, k, first) for k in range(int(room[lane]))]
            told += int(room[lane])
            lane = straight.get(lane, -1)
            if lane < 0 or lane in used:
                break
            used.add(lane)
    lanes_, numbers, ks, fronts = np.array(found, np.int64).reshape(-1, 4).T
    return lanes_, np.stack([numbers, ks]), fronts


def _last(line: Any, place: Any) -> float:
    """Return how far along a line it leaves a place for the last time, metres."""
    points = shapely.points(shapely.get_coordinates(line.intersection(place)))
    return float(shapely.line_locate_point(line, points).max())


def _without_passing(city: City, boxes: NDArray[Any]) -> City:
    """Take away vehicles that drive through outlines."""
    tracks = city.tracks
    if tracks is None or not tracks.count:
        return city
    found = moments_of(tracks, np.arange(0.0, tracks.duration + EVERY, EVERY))
    hit = shapely.STRtree(boxes).query(found.boxes(tracks.size), predicate="intersects")[0]
    gone = np.unique(found.mover[hit])
    gone = gone[~tracks.on_foot[gone]]
    kept = np.setdiff1d(np.arange(tracks.count), gone)
    said = (f"queue: {len(gone)} vehicles that drove through it are taken away",) * bool(len(gone))
    return replace(city, tracks=tracks.take(kept), notes=(*city.notes, *said))


def _looks(city: City, kind: str, count: int) -> list[str]:
    """Return a look for each of some vehicles of a kind."""
    names, shares = zip(*looks_named(kind, profile_of(city.frame).vehicles), strict=True)
    ids = hash_ids(city.seed, f"{ACTION}/{kind}", np.arange(count))
    return [str(names[row]) for row in choose(city.seed, f"{ACTION}/look", ids, shares).tolist()]


def _candidates(
    city: City, names: tuple[str, ...] | None, ground: Corners | None, size: FloatArray, how: str
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return places, (n, 2), where a vehicle would face, (n,) radians, and which are best, 0 first.

    Lanes for parking and bays come before kerbs of driven lanes.
    """
    place = _near(city, names, ground)
    found = [_at_kerbs(city, names, size, how)]
    if how == PARK and size[0] < 5.6:
        bays = join_bays([lot_bays(city), yard_bays(city)])
        found.append((bays.xy, bays.yaw - np.pi / 2, np.zeros(len(bays.id), np.int64)))
    xy, heading, lane = (np.concatenate(parts) for parts in zip(*found, strict=True))
    if place is not None and len(xy):
        shapely.prepare(place)
        near = shapely.intersects_xy(place, xy)
        xy, heading, lane = xy[near], heading[near], lane[near]
    return xy, heading, lane


def _near(city: City, names: tuple[str, ...] | None, ground: Corners | None) -> Any:
    """Return the ground in which vehicles stand at objects, None for everywhere."""
    if names is None and ground is None:
        return None
    return ground_of(city, names, ground, around=AROUND).buffer(ROADSIDE)


def _at_kerbs(
    city: City, names: tuple[str, ...] | None, size: FloatArray, how: str
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return places along the kerbs of streets, on the side where traffic drives their way."""
    network, roads = city.network, city.layout.roads
    assert network is not None
    table = roads.iloc[network.edge_road]
    level = ~(table["bridge"] | table["tunnel"] | table["passage"]).to_numpy(bool)
    level &= (table["layer"].to_numpy() == 0) & ~table["roundabout"].to_numpy(bool)
    driven = table["kind"].isin(_DRIVEN).to_numpy().copy()
    if names is not None:
        ids = find_objects(city, names)
        named = np.isin(table["id"].to_numpy(np.uint64), ids)
        driven &= named if named.any() else np.ones(len(named), bool)
    low, high = free_of(network)
    room = level & driven & (high - low > size[0])
    edges = np.flatnonzero(room)
    row, along = every((high - low - size[0])[edges], STEP, 0.0)
    edge = edges[row]
    along = along + low[edge] + size[0] / 2
    parking = np.zeros((network.edge_count, 2))  # metres of the lane for it, right and left
    bands = bands_of(city.layout, network)
    for number in np.flatnonzero(bands.kind == KIND["parking"]).tolist():
        wide = float(bands.left[number] - bands.right[number])
        parking[bands.edge[number], int(bands.middle[number] > 0)] = wide
    position, onward = locate(network.lines, edge, along)
    left = np.column_stack([-onward[:, 1], onward[:, 0]])
    xy, heading, lane = [], [], []
    oneway = table["oneway"].to_numpy(bool)[edge]
    for side in (-1.0, 1.0):
        own = parking[edge, int(side > 0)]
        inner = KERB + size[1] / 2
        if how == DOUBLE:
            inner = np.where(own > 0, own + BESIDE, ROW) + size[1] / 2
        half = network.half_width[edge] - inner
        fits = half > size[1] / 2 if how == PARK else half > 0.2
        outer = side * np.where(network.left_hand[edge], -1.0, 1.0) < 0
        way = onward * np.where(oneway | outer, 1.0, -1.0)[:, None]
        xy.append((position + left * (side * half)[:, None])[fits])
        heading.append(np.arctan2(way[:, 1], way[:, 0])[fits])
        best = own > 0 if how == PARK else np.ones(len(own), bool)
        lane.append(np.where(best, 0, 1)[fits])
    return np.concatenate(xy), np.concatenate(heading), np.concatenate(lane).astype(np.int64)


_DRIVEN = (
    "trunk", "primary", "secondary", "tertiary", "unclassified", "residential", "living_street",
    "service",
)  # fmt: skip


def _boxes(xy: FloatArray, heading: FloatArray, size: FloatArray, grow: FloatArray) -> NDArray[Any]:
    """(n,) outlines of vehicles, larger by so much lengthwise and aside."""
    long, wide = size / 2 + grow
    c, s = np.cos(heading)[:, None], np.sin(heading)[:, None]
    x, y = np.array([-long, long, long, -long]), np.array([-wide, -wide, wide, wide])
    return np.asarray(shapely.polygons(np.stack([c * x - s * y, s * x + c * y], 2) + xy[:, None]))


def _free(
    city: City, xy: FloatArray, heading: FloatArray, size: FloatArray, moving: NDArray[Any]
) -> NDArray[np.bool_]:
    """(n,) whether a vehicle can stand: on the roadway, clear of things and of what moves there."""
    free = np.ones(len(xy), bool)
    if city.ground is not None:
        free &= city.ground.on(xy, *ROADWAY, *ON_ROADWAY, "parking", "apron")
    things, *_ = placed_outlines(city.scene, (*FURNITURE, "trees", "vehicles", LAYER))
    houses = city.layout.buildings.geometry.to_numpy()
    solid = np.concatenate([things, houses])
    grown = _boxes(xy, heading, size, np.array([APART, 0.05]))
    for shapes, outlines in ((solid, grown), (moving, _boxes(
            xy, heading, size, np.array([PASSING, PASSING])))):  # fmt: skip
        if len(shapes):
            hit = shapely.STRtree(outlines).query(shapes, predicate="intersects")[1]
            free[np.unique(hit)] = False
    return free


def _moving(city: City, *, on_foot: bool = False) -> NDArray[Any]:
    """Where what moves is at some moment; `on_foot` for people alone."""
    tracks = city.tracks
    if tracks is None or not tracks.count:
        return np.zeros(0, object)
    if on_foot:
        tracks = tracks.take(tracks.on_foot)
    found = moments_of(tracks, np.arange(0.0, tracks.duration + EVERY, EVERY))
    return np.asarray(found.boxes(tracks.size), object)


def _spread(
    city: City, xy: FloatArray, heading: FloatArray, lane: IntArray, count: int, size: FloatArray
) -> IntArray:
    """Take places one after the other that are not in each other's, the best ones first."""
    x, y = np.rint(100 * xy).astype(np.int64).view(np.uint64).T if len(xy) else np.zeros((2, 0))
    key = hash_ids(city.seed, f"{ACTION}/spot", x.astype(np.uint64), y.astype(np.uint64))
    order = np.lexsort((key, lane))
    outlines = _boxes(xy, heading, size, np.array([APART / 2, 0.0]))
    taken: list[int] = []
    for row in order.tolist():
        if len(taken) == count:
            break
        if not shapely.intersects(outlines[taken], outlines[row]).any():
            taken.append(row)
    return np.array(taken, np.int64)


def _standing(look: str, detail: int) -> Prototype:
    """Return a vehicle with its wheels as one thing."""
    model = vehicle(look, detail=detail)
    parts = [model.body.mesh]
    parts += [
        moved(wheel.prototype.mesh, wheel.place, yaw=np.pi if wheel.place[0] < 0 else 0.0)
        for wheel in model.wheels
    ]
    parts += [
        moved(part.prototype.mesh, part.place, yaw=np.pi if part.about else 0.0)
        for part in model.parts
        if not part.prototype.name.startswith("driver")
    ]
    return prototype(f"{look}_standing", "vehicle", parts)


def _with(
    city: City, looks: list[str], xy: FloatArray, heading: FloatArray, kind: str, z: FloatArray
) -> City:
    """Put vehicles into the scene, each known by what it is and where it stands."""
    names = sorted(set(looks))
    shapes = [_standing(name, city.lod) for name in names]
    places = np.rint(1000 * xy).astype(np.int64).tolist()
    ids = np.array([stable_id(ACTION, kind, *place) for place in places], np.uint64)
    tint = np.zeros((len(ids), 3), np.float32)
    for row, look in enumerate(looks):
        colors, shares = paints_of(look)
        tint[row] = colors[choose(city.seed, f"{ACTION}/paint", ids[[row]], shares)[0]]
    yaw = heading + np.pi / 2 + np.radians(1.5) * (uniform(city.seed, f"{ACTION}/tilt", ids) - 0.5)
    rotation = np.zeros((len(ids), 3), np.float32)
    rotation[:, 2] = yaw
    rows = Instances(
        np.array([names.index(look) for look in looks], np.int32), ids,
        np.zeros(len(ids), np.uint64), np.column_stack([xy, z]), rotation,
        np.ones((len(ids), 3), np.float32), tint,
    )  # fmt: skip
    scene = with_rows(city.scene, LAYER, shapes, rows)
    return replace(city, scene=scene, stages_done=city.stages_done | {"dynamic"})
