"""People who stay at a place: who stand, talk, wait, sit on benches, or go to and fro in it."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.people.gear import GEAR, WHEELCHAIR
from cityx.city import City
from cityx.city.moments import moments_of
from cityx.city.thing_outlines import FURNITURE, placed_outlines
from cityx.city.tracks import GAIT, MOVER, Tracks, join_tracks, no_tracks
from cityx.edit.land.spots import CORNERS, facing
from cityx.edit.life.places import Corners, Spots, benches_near, ground_of, parks_at
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.geometry.polylines import Polylines
from cityx.ground.walking.walkable import Walkable
from cityx.ground.walking.walks import walk_graph, walks_between
from cityx.ids import hash_ids, stable_id, uniform
from cityx.motion.crowds import among, area_of, dressed, sizes_of, with_crowd
from cityx.motion.feasible import ground_height
from cityx.motion.kinds_of_people import KINDS, WEARS, gaits_of, looks_of_kinds
from cityx.motion.people_trips import Trips, at_pace, paces_of
from cityx.protocol import (
    Choice,
    ObjectName,
    Points,
    Port,
    Range,
    Serves,
    action,
    has_ground,
    has_network,
)

ACTION = "dynamic/gathering-v1"
STAND, TALK, WAIT, SIT = "stand", "talk", "wait", "sit"
WALK, RUNS, PLAY = "walk", "run", "play"
DOINGS = (STAND, TALK, WAIT, SIT, WALK, RUNS, PLAY)
WHO = tuple(KINDS)
USUAL = 8  # people of a gathering that nobody counted
MOST = 2000
APART = 0.75  # metres between people who stand
ROOMY = 1.25  # metres between people with wheelchairs and prams
CIRCLE = 0.55  # metres from the middle of those who talk to each of them
GROUP = (2, 5)  # people who talk together, fewest and most
STEP = 0.4  # metres between the places that are looked at
MANY = 60_000  # places looked at
BY = (5.0, 10.0)  # metres from a ground that nobody walks on to who is at it
WIDE = 2.0  # times the least room of all who come, from which a ground is one that is walked on
NEARBY = 0.6  # metres that are kept to whom passes by, and to things
SEAT = 0.52  # metres of a bench for one
BACK = 0.10  # metres from the middle of a seat to the pelvis, to the back
LOOK = 0.5  # seconds between the moments at which it is looked who passes by
LEGS = 4  # ways of somebody who goes to and fro
LOOKS = 60  # different people who gather in one city


@action(
    ACTION,
    limits=[
        "Who stays keeps out of the way of what moves already; walkers that come later go round.",
        "Where there is room for fewer than are asked for, none is added.",
    ],
    requires=("layout", has_network(), has_ground()),
    takes=(Port("place", "point", optional=True),),
    gives=(Port("pedestrians", "line", role="pedestrian_tracks"),),
    labels=("people", "standing", "talking", "waiting", "sitting", "children", "wheelchair"),
    serves=(
        *(
            Serves("edit=add_agent", "agent=pedestrian", *where, "!to", "!from")
            for where in (("at",), ("ground", "!at"), ("who", "!path", "!at", "!ground"))
        ),
    ),
    binds={
        "within": "at",
        "ground": "ground",
        "doing": "mode",
        "who": "who",
        "count": "count",
        "each": "each",
        "speed": "speed",
        "wears": "wears",
    },
)
def gathering(
    city: City,
    *,
    within: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    ground: Annotated[Corners | None, Points(3, CORNERS)] = None,
    doing: Annotated[str, Choice(*DOINGS)] = STAND,
    count: Annotated[int, Range(1, MOST)] = USUAL,
    who: Annotated[str | None, Choice(*WHO)] = None,
    wears: Annotated[str | None, Choice(*WEARS)] = None,
    speed: Annotated[float | None, Range(0.3, 6.0)] = None,
    each: Annotated[str | None, Choice("yes")] = None,
    seconds: Annotated[float, Range(1.0, 3600.0)] = 60.0,
) -> City:
    """Let people be at a place and do something there; the same once more adds others.

    Parameters
    ----------
    city
        City with its ground.
    within
        Squares, parks and streets that they are in, or objects that they are at; anywhere when left
        out.
    ground
        Corners of ground that they are on besides, (x, y, number of the polygon).
    doing
        Whether they stand each alone, talk in groups, wait in a row, sit on the benches there, or
        walk, run or play to and fro.
    count
        People.
    who
        Of which kind all of them are; mixed when left out.
    wears
        What all of them have on, such as jackets in warning colours; their own clothes when left
        out.
    speed
        Metres per second of who goes to and fro; each has an own when left out.
    each
        "yes" for so many at every one of the objects.
    seconds
        How long, where nothing moves yet.
    """
    if each and within is not None:
        for name in within:
            city = gathering(city, within=(name,), doing=doing, count=count, who=who, wears=wears,
                             speed=speed, seconds=seconds)  # fmt: skip
        return city
    walkable = area_of(city)
    held = city.tracks if city.tracks is not None else no_tracks()
    seconds = max(seconds, held.duration)
    where = [*(within or ()), *(f"{x},{y}" for x, y, *_ in ground or ())]
    purpose = f"{ACTION}/{doing}/{who}/{','.join(where)}/{_times(city)}"
    ids = np.sort(hash_ids(city.seed, "gathering", np.uint64(stable_id(purpose)), np.arange(count)))
    looks = _looks(city, ids, who, wears)
    place = ground_of(city, within, ground)
    if doing in (WALK, RUNS, PLAY):
        return _to_and_fro(city, walkable, place, ids, looks, doing, seconds, held, speed)
    if doing == SIT and who != WHEELCHAIR:
        spots = benches_near(city, place, count, seat=SEAT, back=BACK, taken=_taken(held))
    else:
        spots = _spots_by(
            city, walkable, place, count, doing, ROOMY if who in GEAR else APART, held
        )
    made = _staying(city, ids, looks, spots, seconds, sits=doing == SIT)
    joined = join_tracks([held, made])
    return replace(city, tracks=joined, stages_done=city.stages_done | {"dynamic"})


def _times(city: City) -> int:
    """How many there are of this action already, which tells its calls apart."""
    return 0 if city.tracks is None else int((city.tracks.origin == ACTION).sum())


def _looks(
    city: City, ids: NDArray[np.uint64], who: str | None, wears: str | None
) -> NDArray[np.str_]:
    """(n,) looks of people of a kind."""
    number = (hash_ids(city.seed, f"{ACTION}/look", ids) % np.uint64(LOOKS)).astype(np.int64)
    return looks_of_kinds(number, np.full(len(ids), who or ""), wears=wears or "")


def _staying(
    city: City, ids: NDArray[np.uint64], looks: NDArray[np.str_], spots: Spots, seconds: float, *,
    sits: bool,
) -> Tracks:  # fmt: skip
    """Make tracks of people who stay where they are."""
    count = len(ids)
    place = np.column_stack([spots.xy, ground_height(city, spots.xy)])
    gait = gaits_of(looks, GAIT["sit"] if sits else GAIT["still"])
    both = np.repeat(np.arange(count), 2)
    return Tracks(
        ids, np.full(count, MOVER["pedestrian"], np.uint8), looks, np.full(count, ACTION),
        np.ones((count, 3), np.float32), sizes_of(looks), 2 * np.arange(count + 1, dtype=np.int64),
        np.tile(np.array([0.0, seconds], float), count), np.round(place, 4).astype(float)[both],
        np.round(spots.heading, 4)[both], np.zeros(2 * count, np.float32), gait[both],
        np.zeros(2 * count, np.uint64),
    )  # fmt: skip


# -- where they stay -------------------------------------------------------------------------------


def _spots_by(
    city: City, walkable: Walkable, place: Any, count: int, doing: str, apart: float, held: Tracks
) -> Spots:
    """Find places for people who stand in a ground, or beside one that nobody walks on.

    Raises
    ------
    ActionFailed
        If there is room for fewer.
    """
    for by in (0.0, *BY):
        ground = place.buffer(by) if by else place
        try:
            return _spots(city, walkable, ground, count, doing, apart, held)
        except ActionFailed:
            free = len(_free(city, walkable, place, held, LOOK)) * STEP**2
            if by == BY[-1] or free > WIDE * apart**2 * count:
                raise  # it is full
    raise AssertionError("the last ground returns or raises")


def _spots(
    city: City, walkable: Walkable, place: Any, count: int, doing: str, apart: float, held: Tracks
) -> Spots:
    """Find places for people who stand.

    Raises
    ------
    ActionFailed
        If there is room for fewer.
    """
    free = _free(city, walkable, place, held, LOOK)
    key = hash_ids(city.seed, f"{ACTION}/spot", _keys(free))
    if doing == WAIT:
        middle = shapely.get_coordinates(shapely.centroid(place))[0]
        order = np.argsort(np.round(np.hypot(*(free - middle).T), 3), kind="stable")
    else:
        order = np.argsort(key, kind="stable")
    if doing == TALK:
        return _groups(city, free[order], count)
    xy = _apart(free[order], count, apart, _ease(place, count, doing, apart))
    if doing == WAIT:
        return Spots(xy, facing(city, xy) - np.pi / 2)
    return Spots(xy, 2 * np.pi * uniform(city.seed, f"{ACTION}/turn", _keys(xy)))


def _keys(xy: FloatArray) -> NDArray[np.uint64]:
    """(n,) keys of (n, 2) places, by the centimetre."""
    x, y = np.rint(100 * xy).astype(np.int64).view(np.uint64).T
    return np.asarray(hash_ids(0, "place", x, y))


def _ease(place: Any, count: int, doing: str, apart: float) -> float:
    """Metres that people would leave between them if they spread over a place."""
    return apart if doing == WAIT else max(apart, 0.5 * float(np.sqrt(place.area / count)))


def _free(city: City, walkable: Walkable, place: Any, held: Tracks, every: float) -> FloatArray:
    """(m, 2) places where somebody can stay: walked on or in parks, clear of things and movers."""
    west, south, east, north = place.bounds
    step = max(STEP, float(np.sqrt((east - west) * (north - south) / MANY)))
    x, y = (np.arange(a + step / 2, b, step) for a, b in ((west, east), (south, north)))
    spots = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    shapely.prepare(place)
    spots = spots[shapely.intersects_xy(place, spots)]
    walked = walkable.holds(spots) & (walkable.at(walkable.crosswalk, spots) == 0)
    walked &= ~walkable.at(walkable.verge, spots)
    spots = np.asarray(spots[walked | parks_at(city, spots)], float)
    things, *_ = placed_outlines(city.scene, (*FURNITURE, "trees", "vehicles"))
    for shapes in (things, _ways(held, every)):
        if len(shapes) and len(spots):
            points = shapely.points(spots)
            near = shapely.STRtree(points).query(shapes, predicate="dwithin", distance=NEARBY)[1]
            spots = np.delete(spots, np.unique(near), axis=0)
    return np.asarray(spots, float)


def _ways(held: Tracks, every: float) -> NDArray[Any]:
    """Where what moves already is at some moment: points of people, boxes of vehicles."""
    if not held.count:
        return np.zeros(0, object)
    found = moments_of(held, np.arange(0.0, held.duration + every, every))
    shapes = found.boxes(held.size)
    foot = held.on_foot[found.mover]
    shapes[foot] = shapely.points(found.position[foot, :2])
    return np.asarray(shapes, object)


def _taken(held: Tracks) -> FloatArray:
    """(k, 2) places of those who stay somewhere already."""
    return held.position[held.sample_start[:-1], :2] if held.count else np.zeros((0, 2))


def _apart(free: FloatArray, count: int, least: float, ease: float) -> FloatArray:
    """Take places one after the other, each so far from those before it.

    Raises
    ------
    ActionFailed
        If there is room for fewer.
    """
    apart = ease
    while True:
        found = np.zeros((0, 2))
        for spot in free:
            if len(found) == count:
                return found
            if not len(found) or np.hypot(*(found - spot).T).min() >= apart:
                found = np.vstack([found, spot])
        if len(found) == count:
            return found
        if apart <= least:
            raise ActionFailed(f"There is room for {len(found)} of {count} people there.")
        apart = max(0.7 * apart, least)


def _groups(city: City, free: FloatArray, count: int) -> Spots:
    """Put people into groups who face each other.

    Raises
    ------
    ActionFailed
        If there is room for fewer.
    """
    low, high = GROUP
    sizes: list[int] = []
    while sum(sizes) < count:
        number = np.uint64(len(sizes))
        drawn = low + int(float(uniform(city.seed, f"{ACTION}/group", number)) * (high - low + 1))
        sizes.append(min(drawn, count - sum(sizes)))
    if len(sizes) > 1 and sizes[-1] == 1:  # nobody talks alone
        sizes[-2:] = [sizes[-2] + 1]
    cells = set(map(tuple, np.rint(free / STEP).astype(int).tolist()))
    around = [(i, j) for i in (-2, -1, 0, 1, 2) for j in (-2, -1, 0, 1, 2)]
    open_ = [all((i + a, j + b) in cells for a, b in around)
             for i, j in np.rint(free / STEP).astype(int).tolist()]  # fmt: skip
    middles = _apart(free[np.array(open_, bool)], len(sizes), 4 * CIRCLE, 4 * CIRCLE)
    xy, heading = [], []
    for place, (size, middle) in enumerate(zip(sizes, middles, strict=True)):
        begin = float(uniform(city.seed, f"{ACTION}/circle", np.uint64(place)))
        angle = 2 * np.pi * (begin + np.arange(size) / size)
        away = CIRCLE * max(1.0, size / 4)
        xy.append(middle + away * np.column_stack([np.cos(angle), np.sin(angle)]))
        heading.append(angle + np.pi)
    return Spots(np.concatenate(xy), np.concatenate(heading))


# -- who goes to and fro ---------------------------------------------------------------------------


def _to_and_fro(
    city: City, walkable: Walkable, place: Any, ids: NDArray[np.uint64],
    looks: NDArray[np.str_], doing: str, seconds: float, held: Tracks, speed: float | None,
) -> City:  # fmt: skip
    """Let people walk or run between places of a ground.

    Raises
    ------
    ActionFailed
        If nobody can walk there.
    """
    graph = walk_graph(walkable)
    inside = np.flatnonzero(shapely.intersects_xy(shapely.buffer(place, 1.0), graph.places))
    if len(inside):  # of pieces that no way joins, the largest
        inside = inside[graph.component[inside] == _commonest(graph.component[inside])]
    if len(inside) < 2:
        raise ActionFailed("Nobody can walk there: no sidewalk, path or square is in it.")
    draw = [uniform(city.seed, f"{ACTION}/leg", ids, leg) for leg in range(LEGS + 1)]
    nodes = inside[(np.stack(draw) * len(inside)).astype(int)]  # (legs + 1, n)
    # Few goals are quick: each leg of all people leads to one of a handful of places.
    goals = inside[(np.linspace(0, len(inside) - 1, min(8, len(inside)))).astype(int)]
    for leg in range(1, LEGS + 1):
        nodes[leg] = goals[(draw[leg] * len(goals)).astype(int)]
    walks, joined = walks_between(walkable, nodes[:-1].ravel(), nodes[1:].ravel())
    count = len(ids)
    lines = []
    for row in range(count):
        own = [walks.points[slice(*walks.start[k : k + 2])] for k in range(row, LEGS * count, count)
               if joined[k]]  # fmt: skip
        lines.append(np.concatenate(own) if own else np.zeros((0, 2)))
    able = np.array([len(line) > 1 for line in lines])
    if not able.all():
        raise ActionFailed(f"{int((~able).sum())} of {count} people find no way to and fro there.")
    pace = paces_of(city.seed, ACTION, ids)
    start = np.cumsum([0] + [len(line) for line in lines])
    begun = 0.3 * uniform(city.seed, f"{ACTION}/begun", ids)
    trips = Trips(ids, np.arange(count), Polylines(np.concatenate(lines), start), pace, begun)
    trips = at_pace(city.seed, ACTION, trips, speed, runs=doing != WALK)
    area, gates = among(city, walkable, seconds, held)
    changed = with_crowd(city, area, gates, trips, seconds, ACTION, held)
    return dressed(changed, ids, looks)


def _commonest(pieces: NDArray[np.int32]) -> int:
    """Return the number that is most often among some."""
    return int(np.bincount(pieces).argmax())
