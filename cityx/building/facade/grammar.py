"""Facades: walls are split into storeys and bays, and the bays get openings.

A split grammar (Mueller et al. 2006) compiled to arrays: every step maps a table of rectangles to a
table of smaller ones with `numpy.repeat`, for all walls of the city at once.

References
----------
Mueller, Wonka, Haegler, Ulmer and Van Gool, "Procedural modeling of buildings", SIGGRAPH 2006.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.building.facade.walls import WallTable
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import numbered
from cityx.ids import uniform

# Modes of the grammar.
PUNCHED, STRIP, CURTAIN, HALL, NAVE, SHED = range(6)
# Roles of openings.
WINDOW, BACK, GROUND, FRENCH, DOOR, SERVICE, GARAGE, ROLLER, SHOP = range(9)
DOORS = (DOOR, SERVICE, GARAGE, ROLLER)

MIN_WALL = 1.2  # metres; a shorter wall has no opening
END_GAP = 0.14  # metres of wall between an opening and the end of its wall
EAVE_GAP = 0.16  # metres of wall between an opening and the eave
BLIND_GAP = 0.12  # metres above a neighbour's roof edge
PIER = 0.28  # metres of wall between two openings, at least
MIN_STOREY, MAX_STOREY = 2.3, 6.0  # metres; beyond, the levels of the input do not fit the height
USUAL_STOREY = 3.2
MIN_OPENING = 0.45  # metres, width and height
SHOP_BAY = 4.2  # metres
SHOP_PIER = 0.34  # metres between shopfronts
SHOP_MARGIN = 0.30  # metres between the corner and the first shopfront
ROOM_FOR_SIGN = 0.75  # metres between a shopfront and the floor above
SERVICE_SIZE, GARAGE_SIZE = (1.06, 2.12), (2.6, 2.25)  # metres
LEAST_DOOR = 1.7  # metres of height
FIRST_MAPPED = 700  # number of the first door of a wall that is mapped beside the main one
MIN_GROUND = 2.35  # metres; a lower strip above sloping ground is no storey


@dataclass(frozen=True)
class Fronts:
    """What the grammar needs to know about each of w walls.

    Attributes
    ----------
    building
        (w,) uint64, for random choices.
    mode
        (w,) one of `PUNCHED`, `STRIP`, `CURTAIN`, `HALL`, `NAVE`, `SHED`.
    levels
        (w,) storeys of the part between base and eave.
    pavement
        (w, 3) height of the ground at the start, the middle and the end of the wall; the part's
        base where it hangs above.
    grounded
        (w,) bool, whether the part stands on the ground.
    street, shop, balcony
        (w,) bool: it faces a street; shops are on its ground floor; it may have balconies.
    free
        (w,) metres to the next building in front.
    screened
        (w,) height below which there are no windows for want of light, -inf where there is light.
    bay, width, height, sill
        (w,) metres: bay, window and height of its sill above the floor.
    ground_storey
        (w,) metres, least height of the ground floor.
    corner
        (w,) metres of solid wall at the ends.
    door
        (w,) bool, the main door is in this wall.
    door_along
        (w,) metres from the start, NaN where the grammar may choose.
    door_width, door_height
        (w,) metres.
    """

    building: NDArray[np.uint64]
    mode: IntArray
    levels: IntArray
    pavement: FloatArray
    grounded: NDArray[np.bool_]
    street: NDArray[np.bool_]
    shop: NDArray[np.bool_]
    balcony: NDArray[np.bool_]
    free: FloatArray
    screened: FloatArray
    bay: FloatArray
    width: FloatArray
    height: FloatArray
    sill: FloatArray
    ground_storey: FloatArray
    corner: FloatArray
    door: NDArray[np.bool_]
    door_along: FloatArray
    door_width: FloatArray
    door_height: FloatArray

    @cached_property
    def foot(self) -> FloatArray:
        """(w,) height of the ground where it is highest."""
        return np.asarray(self.pavement.max(axis=1))

    def pavement_at(self, walls: WallTable, wall: IntArray, along: FloatArray) -> FloatArray:
        """Return the height of the ground at places along walls, (k,)."""
        place = np.clip(2 * along / walls.length[wall], 0.0, 2.0)  # halves of the wall
        half = np.minimum(place.astype(np.int64), 1)
        a, b = self.pavement[wall, half], self.pavement[wall, half + 1]
        return np.asarray(a + (place - half) * (b - a))

    def take(self, rows: Any) -> Fronts:
        """Return the facts of the given walls."""
        return Fronts(*(getattr(self, column.name)[rows] for column in fields(self)))


@dataclass(frozen=True)
class Openings:
    """Openings in walls, k of them.

    Attributes
    ----------
    wall
        (k,) row of the wall.
    floor, bay
        (k,) storey above the part's base and bay from the wall's start.
    role
        (k,) one of `WINDOW`, `BACK`, `GROUND`, `FRENCH`, `DOOR`, `SERVICE`, `GARAGE`, `ROLLER`,
        `SHOP`.
    along
        (k,) metres from the wall's start to the middle.
    low
        (k,) height of the lower edge.
    width, height
        (k,) metres.
    """

    wall: IntArray
    floor: IntArray
    bay: IntArray
    role: IntArray
    along: FloatArray
    low: FloatArray
    width: FloatArray
    height: FloatArray

    @property
    def count(self) -> int:
        """Number of openings."""
        return len(self.wall)

    def take(self, rows: Any) -> Openings:
        """Return the given openings (indices or mask)."""
        return Openings(*(getattr(self, column.name)[rows] for column in fields(self)))


@dataclass(frozen=True)
class Storeys:
    """Storeys of w walls: floor i > 0 lies at ``base + ground + (i - 1) * upper``.

    Attributes
    ----------
    count
        (w,) number of storeys, at least 1.
    base
        (w,) height of floor 0.
    ground, upper
        (w,) metres, heights of the ground floor and of the others.
    first
        (w,) the lowest storey that is not in the ground.
    """

    count: IntArray
    base: FloatArray
    ground: FloatArray
    upper: FloatArray
    first: IntArray

    def floor_of(self, wall: IntArray, storey: IntArray) -> FloatArray:
        """Return the heights of floors."""
        above = self.ground[wall] + (storey - 1) * self.upper[wall]
        return np.asarray(self.base[wall] + np.where(storey > 0, above, 0.0))


def storeys_of(walls: WallTable, fronts: Fronts) -> Storeys:
    """Divide the height of walls into storeys; levels that do not fit the height are corrected."""
    height = np.maximum(walls.z_high - walls.z_low, 0.1)
    count = np.maximum(fronts.levels, 1).astype(np.int64)
    mean = height / count
    fits = (mean >= MIN_STOREY) & ((mean <= MAX_STOREY) | (fronts.mode == HALL))
    count = np.where(fits, count, np.maximum(1, np.round(height / USUAL_STOREY)).astype(np.int64))
    count = np.where(np.isin(fronts.mode, [NAVE, SHED]), 1, count)
    count = np.where((fronts.mode == HALL) & (count <= 2), 1, count)
    mean = height / count
    # A higher ground floor takes its height from the others, but leaves them room to stand.
    others = np.maximum(count - 1, 1)
    most = height - others * np.minimum(2.55, mean)
    ground = np.clip(np.maximum(fronts.ground_storey, mean), mean, np.maximum(most, mean))
    ground = np.where((count == 1) | ~fronts.grounded, mean, ground)
    upper = np.where(count > 1, (height - ground) / others, height)
    # On a slope the lower storeys disappear in the ground.
    sunk = fronts.pavement.min(axis=1) - walls.z_low
    first = np.ceil((sunk - ground + MIN_GROUND) / np.maximum(upper, 0.1)).astype(np.int64)
    first = np.where(sunk > 0.05, np.clip(first, 0, count), 0)
    return Storeys(count, walls.z_low, ground, upper, first)


def bays_of(
    walls: WallTable, fronts: Fronts
) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
    """Divide the length of walls into bays.

    Returns
    -------
    count
        (w,) bays, 0 for walls that take none.
    margin, bay, width
        (w,) metres before the first bay, of a bay, and of its window (narrower on short walls).
    """
    corner = np.minimum(fronts.corner, 0.12 * walls.length)
    usable = walls.length - 2 * corner
    width = np.where(fronts.mode == STRIP, 0.0, fronts.width)
    count = np.maximum(1, np.round(usable / np.maximum(fronts.bay, 0.5))).astype(np.int64)
    fitting = np.floor(usable / (width + PIER)).astype(np.int64)
    count = np.minimum(count, np.maximum(fitting, 1))
    bay = usable / count
    room = np.minimum(bay - PIER / 2, walls.length - 2 * END_GAP - 0.1)
    width = np.where(fronts.mode == STRIP, bay - 0.10, np.minimum(fronts.width, room))
    count = np.where((walls.length >= MIN_WALL) & (width >= MIN_OPENING), count, 0)
    return count, corner, bay, width


@dataclass(frozen=True)
class MappedDoors:
    """Where a map draws doors beside the main ones, d of them, and where it says there is none.

    Attributes
    ----------
    wall, role
        (d,) wall of each door, and one of `DOOR`, `SERVICE`, `GARAGE`.
    along
        (d,) metres from the wall's start.
    wall_without, along_without
        (k,) both: the places without a door.
    """

    wall: IntArray
    role: IntArray
    along: FloatArray
    wall_without: IntArray
    along_without: FloatArray


def lay_out(
    walls: WallTable, fronts: Fronts, seed: int, mapped: MappedDoors | None = None
) -> Openings:
    """Place every opening of every wall.

    Parameters
    ----------
    walls
        Rectangles of walls with their party spans.
    fronts
        What is known of each.
    seed
        Seed of the city.
    mapped
        Doors of the map beside the main ones.

    Returns
    -------
    openings
        Sorted by wall, storey and bay. None lies on a stretch that a neighbour covers, beyond a
        wall's ends, above its eave, or below the ground.
    """
    storeys = storeys_of(walls, fronts)
    doors = _main_doors(walls, fronts, storeys)
    shops = _shops(walls, fronts, storeys, doors)
    gates = _gates(walls, fronts, storeys, seed)
    windows = _windows(walls, fronts, storeys, seed)
    if mapped is not None:
        more = _mapped_doors(walls, fronts, storeys, mapped, doors)
        shops = shops.take(_apart(shops, more, walls.count))
        doors = _joined([doors, more])
        gates = gates.take(_apart(gates, _walled(walls, mapped), walls.count))
    gates = gates.take(_apart(gates, _joined([doors, shops]), walls.count))
    windows = windows.take(_apart(windows, _joined([doors, shops, gates]), walls.count))
    every = _joined([windows, shops, doors, gates])
    every = every.take(_inside(every, walls, fronts))
    return every.take(np.lexsort((every.role, every.bay, every.floor, every.wall)))


def _joined(tables: list[Openings]) -> Openings:
    return Openings(
        *(np.concatenate([getattr(t, c.name) for t in tables]) for c in fields(Openings))
    )


def _windows(walls: WallTable, fronts: Fronts, storeys: Storeys, seed: int) -> Openings:
    """Windows of all storeys, ground floor included."""
    bays, margin, bay_width, width = bays_of(walls, fronts)
    bays = np.where(fronts.mode == CURTAIN, 0, bays)
    number = np.maximum(storeys.count - storeys.first, 0) * bays
    wall = np.repeat(np.arange(walls.count), number)
    cell = numbered(number)
    storey = storeys.first[wall] + cell // np.maximum(bays[wall], 1)
    bay = cell % np.maximum(bays[wall], 1)
    floor = storeys.floor_of(wall, storey)
    room = np.where(storey == 0, storeys.ground[wall], storeys.upper[wall])
    along = margin[wall] + (bay + 0.5) * bay_width[wall]
    mode = fronts.mode[wall]
    building = fronts.building[wall]
    street = fronts.street[wall]
    ground = (storey == storeys.first[wall]) & fronts.grounded[wall]
    sill, height = fronts.sill[wall], fronts.height[wall]
    wide = width[wall]
    # Storeys differ: a tall first floor in old houses, a low one under the roof.
    sill = np.where(ground & (mode == PUNCHED) & (room > 3.4), sill + 0.2, sill)
    height = np.minimum(height, room - sill - 0.38)
    role = np.where(ground, GROUND, np.where(street, WINDOW, BACK))
    # Yards: smaller windows, some bays left out.
    back = ~street & (mode == PUNCHED)
    smaller = np.where(back, 0.9, 1.0)
    height, wide = height * smaller, wide * smaller
    gap = uniform(seed, "facade/back gap", building ^ wall_key(walls)[wall], bay) < 0.18
    kept = ~(back & gap & (bays[wall] > 1))
    # Balconies stand in a rhythm, symmetric about the middle, from the first floor up.
    turn = np.minimum(bay, bays[wall] - 1 - bay)
    phase = (uniform(seed, "facade/balcony phase", building) * 2).astype(np.int64)
    rhythm = (uniform(seed, "facade/balcony rhythm", building) * 5).astype(np.int64)
    upper = storey - storeys.first[wall]
    inner = (upper > 1) & (storey < storeys.count[wall] - 1)
    having = np.choose(
        rhythm,
        [
            (turn + phase) % 2 == 0,  # every other column
            turn % 3 == 2 * phase,
            (turn // 2 + phase) % 2 == 0,  # pairs
            (turn + phase + upper) % 2 == 0,  # in turn, storey by storey
            ((turn + phase) % 2 == 0) & inner,
        ],
    )
    french = (
        fronts.balcony[wall]
        & (mode == PUNCHED)
        & (storey > storeys.first[wall])
        & having
        & (room > 2.5)
        & (bay_width[wall] > 1.9)
        & (fronts.free[wall] > 4.0)
        & (wide > 0.8)
    )
    role = np.where(french, FRENCH, role)
    low = floor + np.where(french, 0.06, sill)
    height = np.where(french, np.minimum(2.3, room - 0.45), height)
    # Halls are lit from high up, naves by tall windows.
    hall = (mode == HALL) & (storeys.count[wall] == 1)
    eave = walls.z_high[wall]
    low = np.where(hall, eave - np.clip(0.28 * room, 1.3, 2.6), low)
    height = np.where(hall, np.minimum(1.1, eave - low - 0.3), height)
    kept &= ~(hall & (uniform(seed, "facade/hall", wall_key(walls)[wall], bay // 3) < 0.25))
    nave = mode == NAVE
    low = np.where(nave, floor + np.clip(0.24 * room, 1.0, 4.0), low)
    height = np.where(nave, np.clip(0.52 * room, 0.8, 7.5), height)
    wide = np.where(nave, np.minimum(wide, 0.45 * height), wide)
    kept &= (low > fronts.screened[wall]) | street
    shed = mode == SHED
    kept &= ~(
        shed & ((uniform(seed, "facade/shed", wall_key(walls)[wall], bay) < 0.72) | (room < 2))
    )
    found = Openings(wall, storey, bay, role, along, low, wide, height)
    return found.take(kept & (height >= MIN_OPENING) & (wide >= MIN_OPENING))


def wall_key(walls: WallTable) -> NDArray[np.uint64]:
    """Key walls by where they are, in centimetres; the same for every order of rows, (w,)."""
    middle = np.rint((walls.start + walls.end) * 50).astype(np.int64).view(np.uint64)
    with np.errstate(over="ignore"):
        return np.asarray(
            middle[:, 0] * np.uint64(0x9E3779B97F4A7C15)
            + middle[:, 1] * np.uint64(0xD6E8FEB86659FD93)
        )


def _main_doors(walls: WallTable, fronts: Fronts, storeys: Storeys) -> Openings:
    wall = np.flatnonzero(fronts.door)
    bays, margin, bay_width, _ = bays_of(walls, fronts)
    width = np.minimum(fronts.door_width[wall], walls.length[wall] - 2 * END_GAP - 0.04)
    # In the middle bay, or beside a shop at the end, unless the map says where.
    middle = bays[wall] // 2
    own = np.where(
        bays[wall] > 0, margin[wall] + (middle + 0.5) * bay_width[wall], walls.length[wall] / 2
    )
    end = SHOP_MARGIN + width / 2 + 0.1
    own = np.where(fronts.shop[wall] & (walls.length[wall] > 4.5), end, own)
    mapped = fronts.door_along[wall]
    along = np.where(np.isfinite(mapped), mapped, own)
    reach = width / 2 + END_GAP + 0.01
    along = np.clip(along, reach, walls.length[wall] - reach)
    top = np.minimum(walls.z_high[wall] - EAVE_GAP, walls.open_to[wall])
    low = fronts.pavement_at(walls, wall, along)
    height = np.minimum(fronts.door_height[wall], top - low - 0.02)
    role = np.full(len(wall), DOOR)
    none = np.full(len(wall), -1)
    return Openings(wall, storeys.first[wall], none, role, along, low, width, height)


def _mapped_doors(
    walls: WallTable, fronts: Fronts, storeys: Storeys, mapped: MappedDoors, main: Openings
) -> Openings:
    """Doors that the map draws beside the main ones, of those too close together the first."""
    wall, role = mapped.wall, mapped.role
    width = np.select([role == SERVICE, role == GARAGE], [SERVICE_SIZE[0], GARAGE_SIZE[0]],
                      fronts.door_width[wall])  # fmt: skip
    height = np.select([role == SERVICE, role == GARAGE], [SERVICE_SIZE[1], GARAGE_SIZE[1]],
                       fronts.door_height[wall])  # fmt: skip
    width = np.minimum(width, walls.length[wall] - 2 * END_GAP - 0.04)
    reach = width / 2 + END_GAP + 0.01
    along = np.clip(mapped.along, reach, walls.length[wall] - reach)
    low = fronts.pavement_at(walls, wall, along)
    top = np.minimum(walls.z_high[wall] - EAVE_GAP, walls.open_to[wall])
    height = np.minimum(height, top - low - 0.02)
    number = FIRST_MAPPED + _number_in_wall(wall)
    found = Openings(wall, storeys.first[wall], number, role, along, low, width, height)
    found = found.take(_apart(found, main, walls.count) & (height >= LEAST_DOOR))
    order = np.lexsort((found.along, found.wall))
    kept: list[int] = []
    for row in order.tolist():
        last = kept[-1] if kept and found.wall[kept[-1]] == found.wall[row] else None
        if (
            last is None
            or found.along[row] - found.along[last]
            > (found.width[row] + found.width[last]) / 2 + 2 * END_GAP
        ):
            kept.append(row)
    return found.take(np.array(kept, np.int64))


def _number_in_wall(wall: IntArray) -> IntArray:
    """Return the number of each row among those of its wall, in their order, (k,)."""
    order = np.argsort(wall, kind="stable")
    number = np.empty(len(wall), np.int64)
    _, count = np.unique(wall[order], return_counts=True)
    number[order] = numbered(count)
    return number


def _walled(walls: WallTable, mapped: MappedDoors) -> Openings:
    """Places without a door as openings that gates keep clear of."""
    wall = mapped.wall_without
    none, low = np.full(len(wall), -1), walls.z_low[wall]
    height = walls.z_high[wall] - low
    return Openings(wall, none, none, none, mapped.along_without, low,
                    np.full(len(wall), SERVICE_SIZE[0]), height)  # fmt: skip


def _shops(walls: WallTable, fronts: Fronts, storeys: Storeys, doors: Openings) -> Openings:
    """Shopfronts left and right of the main door."""
    door_from = walls.length.copy()
    door_to = walls.length.copy()
    door_from[doors.wall] = doors.along - doors.width / 2 - 0.2
    door_to[doors.wall] = doors.along + doors.width / 2 + 0.2
    asked = np.flatnonzero(fronts.shop & fronts.grounded & (storeys.first < storeys.count))
    rows = np.concatenate([asked, asked])
    right = np.repeat([False, True], len(asked))
    begin = np.where(right, door_to[rows], SHOP_MARGIN)
    finish = np.where(right, walls.length[rows] - SHOP_MARGIN, door_from[rows])
    finish = np.minimum(finish, walls.length[rows] - SHOP_MARGIN)
    run = finish - begin
    count = np.where(run >= 2.0, np.maximum(1, np.round(run / SHOP_BAY)), 0).astype(np.int64)
    wall = np.repeat(rows, count)
    piece = np.repeat(np.arange(len(rows)), count)
    number = numbered(count)
    bay = run[piece] / count[piece]
    along = begin[piece] + (number + 0.5) * bay
    first = storeys.first[wall]
    ceiling = storeys.floor_of(wall, first + 1)
    low = fronts.pavement_at(walls, wall, along)
    height = np.clip(ceiling - low - ROOM_FOR_SIGN, 2.2, 3.5)
    height = np.minimum(height, walls.z_high[wall] - low - EAVE_GAP - 0.01)
    number = number + 500 * right[piece]
    role = np.full(len(wall), SHOP)
    return Openings(wall, first, number, role, along, low, bay - SHOP_PIER, height)


def _gates(walls: WallTable, fronts: Fronts, storeys: Storeys, seed: int) -> Openings:
    """Roller gates of halls and garage doors of sheds and some houses."""
    key = wall_key(walls)
    hall = (fronts.mode == HALL) & (walls.length > 8) & (fronts.street | (fronts.free > 8))
    hall &= uniform(seed, "facade/gate wall", key) < np.where(fronts.street, 0.75, 0.3)
    shed = (fronts.mode == SHED) & fronts.door & (walls.length > 5.4)
    asked = np.flatnonzero((hall | shed) & fronts.grounded)
    pitch = np.where(fronts.mode[asked] == HALL, 8.5, 3.0)
    run = walls.length[asked] - 1.0
    count = np.maximum(0, np.floor(run / pitch)).astype(np.int64)
    wall = np.repeat(asked, count)
    number = numbered(count)
    pitch = np.repeat(run / np.maximum(count, 1), count)
    along = 0.5 + (number + 0.5) * pitch
    is_hall = fronts.mode[wall] == HALL
    kept = ~is_hall | (uniform(seed, "facade/gate", key[wall], number) < 0.55)
    low = fronts.pavement_at(walls, wall, along)
    room = walls.z_high[wall] - low
    height = np.where(is_hall, np.minimum(4.2, room - 1.9), np.minimum(2.25, room - 0.3))
    width = np.where(is_hall, np.minimum(4.0, 0.95 * height + 0.6), 2.5)
    role = np.where(is_hall, ROLLER, GARAGE)
    found = Openings(wall, storeys.first[wall], 900 + number, role, along, low, width, height)
    return found.take(kept & (height > 1.8))


def _apart(table: Openings, others: Openings, walls: int) -> NDArray[np.bool_]:
    """(k,) whether each opening keeps clear of the others in its wall."""
    clear = np.ones(table.count, bool)
    if not others.count or not table.count:
        return clear
    order = np.argsort(others.wall, kind="stable")
    start = np.searchsorted(others.wall[order], np.arange(walls + 1))
    count = np.diff(start)[table.wall]
    row = np.repeat(np.arange(table.count), count)
    step = numbered(count)
    other = order[start[table.wall[row]] + step]
    beside = np.abs(table.along[row] - others.along[other])
    near = beside < (table.width[row] + others.width[other]) / 2 + 0.16
    near &= table.low[row] < others.low[other] + others.height[other] + 0.45
    near &= table.low[row] + table.height[row] > others.low[other] - 0.1
    clear[row[near]] = False
    return clear


def _inside(table: Openings, walls: WallTable, fronts: Fronts) -> NDArray[np.bool_]:
    """(k,) whether each opening lies wholly within the open stretch of its wall."""
    wall = table.wall
    top = table.low + table.height
    half = table.width / 2
    on_ground = np.isin(table.role, [*DOORS, SHOP])
    ends = (table.along - half, table.along, table.along + half)
    below = np.maximum.reduce([fronts.pavement_at(walls, wall, end) for end in ends])
    # Doors lead out at the pavement, though it lies below the lowest floor.
    floor = np.where(on_ground, fronts.pavement_at(walls, wall, table.along),
                     np.maximum(walls.z_low[wall], below))  # fmt: skip
    covered = walls.blind_to[wall] > walls.z_low[wall]
    above = np.where(covered, walls.blind_to[wall] + BLIND_GAP, -np.inf)
    fits = (table.along - half >= END_GAP - 1e-6) & (
        table.along + half <= walls.length[wall] - END_GAP + 1e-6
    )
    fits &= (top <= walls.z_high[wall] - EAVE_GAP + 1e-6) & (top <= walls.open_to[wall])
    fits &= table.low >= floor + np.where(on_ground, -1e-6, 0.12)
    fits &= table.low >= above
    return np.asarray(fits & (table.width >= MIN_OPENING) & (table.height >= MIN_OPENING))
