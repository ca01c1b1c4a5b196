"""Fronts: what the facade grammar needs to know about every wall of a city."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.openings.doors import DOORS
from cityx.assets.openings.windows import WINDOWS
from cityx.assets.styles.facade_styles import FacadeStyle, Weighted
from cityx.assets.styles.palette_tables import GROUP_OF, PAINTED
from cityx.assets.styles.palettes import GROUPS, groups_of, landuse_of, owner_rows
from cityx.building.catalogue import looks
from cityx.building.facade import grammar as facades
from cityx.building.facade.frontage import CLOSE, door_walls, frontage_of, walls_at
from cityx.building.facade.grammar import Fronts
from cityx.building.facade.walls import WallTable
from cityx.building.shell import PARAPET_HIGH, PARAPET_LOW, PARAPET_SHARE
from cityx.building.volumes import GROUNDED
from cityx.city.ground import KERB_HEIGHT
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import choose, uniform

if TYPE_CHECKING:
    from cityx.building.volumes import Volumes
    from cityx.city.city import City
    from cityx.city.layout import Layout

Words = NDArray[np.str_]

MODES = {
    "punched": facades.PUNCHED, "strip": facades.STRIP, "curtain": facades.CURTAIN,
    "hall": facades.HALL, "nave": facades.NAVE, "shed": facades.SHED,
}  # fmt: skip
# How much a street is worth as an address, and the share of its houses with shops.
STREETS: dict[str, tuple[float, float]] = {
    "primary": (3.0, 0.6), "secondary": (3.0, 0.62), "tertiary": (2.8, 0.55), "trunk": (2.5, 0.5),
    "primary_link": (2.0, 0.3), "secondary_link": (2.0, 0.3), "tertiary_link": (2.0, 0.3),
    "pedestrian": (3.0, 0.65), "living_street": (2.6, 0.3), "residential": (2.6, 0.28),
    "unclassified": (2.6, 0.36), "road": (2.0, 0.2), "service": (1.0, 0.0), "track": (0.4, 0.0),
}  # fmt: skip
DOORSTEP = 0.6  # metres before a door that must be ground
WATER = ("water", "river", "sea", "pool")
ENTRANCE = 15.0  # what a zone made for the entrance is worth as the place of the door
NO_ENTRANCE = 20.0  # what a wall loses as the place of the door by a place without one
SAME_DOOR = 0.05  # metres
# Values of entrance=* and door=*.
FOR_CARS = frozenset({"garage", "overhead", "parking"})
BEHIND = frozenset(
    {"service", "emergency", "exit", "fire_exit", "delivery", "secondary", *FOR_CARS}
)
NO_DOORS = frozenset({"no", "none", "disused", "blocked"})
MIN_DOOR_WALL = 1.4  # metres
MIN_DOOR_ROOM = 2.05  # metres of height a door needs
DOOR_STOREY = 2.3  # metres of wall for a door of full height
LOWER_PART = 0.2  # share of an opening's height that nothing may stand before
LOOK = 0.45  # metres before an opening that must be free; it may stand 8 cm out of its wall
EAVE_ROOM = 0.25  # metres under the eave of a pitched roof, where the overhang hides the wall
AT_ONCE = 5000  # parts whose neighbours are looked for together, so that pairs take little room
QUIET = ("residential", "living_street", "service", "track")  # streets that people live on
MOST_QUIET = 0.26  # share of shops there before the place counts; what the map shows is beside it
QUARTER = 120.0  # metres around a building in which trade draws trade
MIN_SHOP_STOREY = 2.9  # metres


@dataclass(frozen=True)
class Designs:
    """What is drawn once per building, for each of n parts.

    Attributes
    ----------
    style
        (n,) key of the look (`cityx.building.catalogue.looks`).
    window, surround, back, door, head, railing, base
        (n,) names of prototypes, "" for none.
    string, pipe
        (n,) bool.
    cooling
        (n,) share of windows with an outdoor unit.
    entrance
        (n,) bool, whether the main door belongs to the part.
    """

    style: Words
    window: Words
    surround: Words
    back: Words
    door: Words
    head: Words
    railing: Words
    base: Words
    string: NDArray[np.bool_]
    pipe: NDArray[np.bool_]
    balcony: NDArray[np.bool_]
    cooling: FloatArray
    entrance: NDArray[np.bool_]


def designs_of(style: Words, building: NDArray[np.uint64], seed: int) -> Designs:
    """Draw window, surround, door and ornament of every part by its building."""
    count = len(style)

    def words() -> Words:
        return np.full(count, "", "U20")

    made = Designs(
        style, words(), words(), words(), words(), words(), words(), words(),
        np.zeros(count, bool), np.zeros(count, bool), np.zeros(count, bool), np.zeros(count),
        np.zeros(count, bool),
    )  # fmt: skip
    for name in np.unique(style).tolist():
        rows = np.flatnonzero(style == name)
        rule: FacadeStyle = looks()[name].facade
        ids = building[rows]

        def draw(what: str, options: Weighted, ids: Any = ids) -> Words:
            drawn = choose(seed, f"facade/{what}", ids, [weight for _, weight in options])
            return np.array([word for word, _ in options], "U20")[drawn]

        made.window[rows] = draw("window", rule.windows)
        made.surround[rows] = draw("surround", rule.surrounds)
        made.back[rows] = rule.back
        made.door[rows] = draw("door", rule.doors)
        made.head[rows] = draw("head", rule.heads)
        made.railing[rows] = draw("railing", rule.balconies)
        made.base[rows] = draw("base", rule.base)
        made.string[rows] = uniform(seed, "facade/string", ids) < rule.string
        made.balcony[rows] = uniform(seed, "facade/balconies", ids) < rule.balcony
        made.pipe[rows] = rule.pipe
        made.cooling[rows] = rule.cooling
        made.entrance[rows] = rule.entrance
    return made


def reserve_of(volumes: Volumes, parts: Any, seed: int) -> FloatArray:
    """Metres below each part's eave that belong to parapet or eaves, (n,)."""
    flat = parts["roof_shape"].to_numpy(str) == "flat"
    ids = parts["id"].to_numpy(np.uint64)
    parapet = PARAPET_LOW + (PARAPET_HIGH - PARAPET_LOW) * uniform(seed, "parapet", ids)
    parapet = np.minimum(parapet, PARAPET_SHARE * (volumes.top - volumes.base))
    tall = volumes.eave - volumes.base
    reserve = np.minimum(np.where(flat, parapet, EAVE_ROOM), 0.3 * tall)
    # A low base that carries the rest of a house gives of its parapet what a door needs.
    _, of, parts_of = np.unique(volumes.building, return_inverse=True, return_counts=True)
    low = np.where(parts["base"].to_numpy(float) < GROUNDED, tall - reserve, 0.0)
    most = np.zeros(len(parts_of))
    np.maximum.at(most, of, low)
    needed = (parts_of[of] > 1) & (most[of] < MIN_DOOR_ROOM) & (low > 0)
    return np.where(needed, np.clip(tall - DOOR_STOREY, 0.0, reserve), reserve)


def lowered(walls: WallTable, reserve: FloatArray) -> WallTable:
    """Take the parapet off the top of walls: what is left has storeys."""
    high = walls.z_high - reserve[walls.part]
    return replace(
        walls,
        z_high=high,
        blind_to=np.minimum(walls.blind_to, high),
        open_to=np.minimum(walls.open_to, high),
    )


def fronts_of(
    city: City,
    volumes: Volumes,
    walls: WallTable,
    designs: Designs,
    walled: Words,
    trade: FloatArray | None = None,
) -> Fronts:
    """Gather the facts of all walls.

    Parameters
    ----------
    walls
        Walls up to the ceiling of the last storey (`lowered`).
    walled
        (n,) material of the walls of each part.
    trade
        As of `trade_of`, worked out when left out.
    """
    layout, seed = city.layout, city.seed
    parts = layout.parts
    part = walls.part.astype(np.int64)
    building = volumes.building[part]
    group = groups_of(layout, seed)
    mode = _modes(designs.style, walled)[part]
    kinds = layout.roads["kind"].to_numpy(str)
    blocked = layout.roads["tunnel"].to_numpy(bool) | layout.roads["passage"].to_numpy(bool)
    is_street = np.isin(kinds, list(STREETS)) & ~blocked
    lines = layout.roads.geometry.to_numpy().copy()
    lines[~is_street] = None
    obstacles = np.where(volumes.walls, volumes.polygons, shapely.Polygon())
    front = frontage_of(walls, lines, obstacles, volumes.base, volumes.eave)
    kind = np.where(front.street >= 0, np.append(kinds, "")[front.street], "")
    worth, share = _worth(kind)
    dry = ~_on_water(layout, walls)
    grounded = parts["base"].to_numpy(float)[part] < GROUNDED
    pavement = np.where(grounded[:, None], _ground_at(city, walls), walls.z_low[:, None])

    room = np.minimum(walls.z_high, walls.open_to) - pavement.min(axis=1)
    usable = grounded & (walls.length >= MIN_DOOR_WALL) & (room >= MIN_DOOR_ROOM)
    usable &= (walls.blind_to <= walls.z_low + 0.05) & dry
    score = 10 * worth + np.minimum(walls.length, 14.0) - 0.4 * np.minimum(front.distance, 20.0)
    score = score + np.minimum(front.free, 6.0) - 25.0 * (front.free < CLOSE)
    score = score + ENTRANCE * designs.entrance[part]
    entrances = entrances_of(layout.points)
    without, place = walls_at(walls, usable, entrances.places[entrances.closed])
    score -= NO_ENTRANCE * np.isin(np.arange(walls.count), without)
    open_ = entrances.open
    rows, along = door_walls(walls, building, usable, np.round(score, 3),
                             entrances.places[open_], entrances.rank[open_])  # fmt: skip
    door = np.zeros(walls.count, bool)
    door[rows] = True
    door_along = np.full(walls.count, np.nan)
    door_along[rows] = along
    for wall in np.intersect1d(rows[np.isnan(along)], without).tolist():
        door_along[wall] = _far_from(place[without == wall], float(walls.length[wall]))

    trade = trade_of(layout, seed) if trade is None else trade
    share = np.minimum(share * trade[part], np.where(np.isin(kind, QUIET), MOST_QUIET, 1.0))
    shop = _shops(city, part, group, mode, worth, share, building, _least_shops(designs.style))
    size = _sizes(designs, building, part, seed)
    levels = (np.maximum(parts["levels"].to_numpy(np.int64), 1) + volumes.cellars)[part]
    tall = (walls.z_high - walls.z_low) / levels
    shop &= (levels > 1) | (tall >= MIN_SHOP_STOREY)
    shop &= grounded & dry & (worth >= 2.0) & (walls.length >= 2.6)
    ground_storey = np.where(shop, np.maximum(size["ground_storey"], 3.9), size["ground_storey"])
    door_width, door_height = _door_sizes(designs.door[part], seed, building)
    return Fronts(
        building, mode, levels, pavement, grounded,
        dry & (worth >= 2.0), shop, designs.balcony[part], front.free, front.screened,
        size["bay"], size["width"], size["height"], size["sill"], ground_storey, size["corner"],
        door, door_along, door_width, door_height,
    )  # fmt: skip


def walled_up(
    volumes: Volumes, walls: WallTable, wall: IntArray, along: FloatArray, low: FloatArray,
    width: FloatArray, height: FloatArray,
) -> NDArray[np.bool_]:  # fmt: skip
    """Return which openings have a building part right before them, its own or another, (k,).

    Walls that meet a neighbour at a sharp angle are free over a part of their length only.

    Parameters
    ----------
    wall
        (k,) wall of each opening.
    along, low, width, height
        (k,) metres: its middle from the wall's start, its lower edge, its size.
    """
    unit = (walls.end - walls.start) / np.maximum(walls.length, 1e-9)[:, None]
    polygons = np.where(volumes.walls, volumes.polygons, shapely.Polygon())
    tree = shapely.STRtree(polygons)
    used = np.unique(wall)
    ahead = np.stack([walls.start[used], walls.end[used]], axis=1)
    ahead = ahead + LOOK * walls.normal[used][:, None]
    hit, _ = tree.query(shapely.linestrings(ahead), predicate="dwithin", distance=LOOK - 0.01)
    near = np.zeros(walls.count, bool)
    near[used[hit]] = True  # also where a narrow court of its own part lies before the wall
    rows = np.flatnonzero(near[wall])
    at = wall[rows]
    half = np.maximum(width[rows] / 2 - 0.05, 0.05)
    middle = walls.start[at] + unit[at] * along[rows, None]
    a, b = middle - unit[at] * half[:, None], middle + unit[at] * half[:, None]
    near_by, far = 0.06 * walls.normal[at], LOOK * walls.normal[at]
    strips = shapely.polygons(np.stack([a + near_by, a + far, b + far, b + near_by], axis=1))
    strip, part = tree.query(strips, predicate="intersects")
    z = (low + LOWER_PART * height)[rows][strip]
    hit = (z > volumes.base[part]) & (z < volumes.eave[part])
    found = np.zeros(len(wall), bool)
    found[rows[strip[hit]]] = True
    return found


def _modes(style: Words, walled: Words) -> IntArray:
    """Return the mode of each part; what the input says is not of glass has windows, (n,)."""
    known, index = np.unique(style, return_inverse=True)
    table = np.array([MODES[looks()[name].facade.mode] for name in known.tolist()], int)
    mode = table[index] if len(style) else np.zeros(0, int)
    solid = (mode == facades.CURTAIN) & ~np.isin(walled, ("glass_wall", PAINTED["glass_wall"]))
    return np.where(solid, facades.STRIP, mode)


def _ground_at(city: City, walls: WallTable) -> FloatArray:
    """Height of the pavement at the start, the middle and the end of walls, (w, 3)."""
    middle = (walls.start + walls.end) / 2
    heights = [city.terrain.height_at(at) for at in (walls.start, middle, walls.end)]
    return np.column_stack(heights) + KERB_HEIGHT


def _worth(kind: Words) -> tuple[FloatArray, FloatArray]:
    known, index = np.unique(kind, return_inverse=True)
    table = np.array([STREETS.get(word, (0.0, 0.0)) for word in known.tolist()]).reshape(-1, 2)
    both = table[index] if len(kind) else np.zeros((0, 2))
    return both[:, 0], both[:, 1]


def _on_water(layout: Layout, walls: WallTable) -> NDArray[np.bool_]:
    """(n,) whether water reaches the ground before a wall."""
    areas = layout.areas
    water = areas.geometry.to_numpy()[np.isin(areas["kind"].to_numpy(str), WATER)]
    ends = np.stack([walls.start, walls.end], axis=1) + DOORSTEP * walls.normal[:, None]
    before = shapely.linestrings(ends)
    found = np.zeros(walls.count, bool)
    found[shapely.STRtree(water).query(before, predicate="intersects")[0]] = True
    return found


@dataclass(frozen=True)
class Entrances:
    """Entrances and doors of a map, e of them.

    Attributes
    ----------
    row
        (e,) rows of the points of the layout.
    places
        (e, 2) metres.
    rank
        (e,) the lower the more it is the main one of its building.
    role
        (e,) one of `DOOR`, `SERVICE`, `GARAGE` of the grammar.
    closed
        (e,) bool, whether the map says that there is none.
    above
        (e,) bool, whether it is on another floor than the ground's.
    """

    row: IntArray
    places: FloatArray
    rank: IntArray
    role: IntArray
    closed: NDArray[np.bool_]
    above: NDArray[np.bool_]

    @property
    def open(self) -> NDArray[np.bool_]:
        """(e,) whether there is a door at the ground."""
        return ~self.closed & ~self.above


def entrances_of(points: Any) -> Entrances:
    """Read the entrances among the points of a layout."""
    rows = np.flatnonzero(points["kind"].to_numpy(str) == "entrance")
    shapes = points.geometry.to_numpy()[rows]
    own = [json.loads(text or "{}") for text in points["tags"].to_numpy(str)[rows].tolist()]
    words = [{tags.get("entrance", ""), tags.get("door", "")} for tags in own]
    rank = [0 if "main" in said else 2 if said & BEHIND else 1 for said in words]
    role = [facades.GARAGE if said & FOR_CARS else facades.SERVICE if said & BEHIND
            else facades.DOOR for said in words]  # fmt: skip
    return Entrances(
        rows,
        np.column_stack([shapely.get_x(shapes), shapely.get_y(shapes)]),
        np.array(rank, int),
        np.array(role, int),
        np.array([bool(said & NO_DOORS) for said in words], bool),
        np.array([_is_above(tags.get("level", "")) for tags in own], bool),
    )


def _far_from(places: FloatArray, length: float) -> float:
    """Return where along a wall a door is farthest from places without one."""
    tried = length * np.array([0.5, 0.25, 0.75])
    return float(tried[np.argmax(np.abs(tried[:, None] - places).min(axis=1))])


def _is_above(level: str) -> bool:
    """Return whether none of the floors that a tag names is the ground's."""
    floors = re.findall(r"-?\d+(?:\.\d+)?", level)
    return bool(floors) and "0" not in floors


def mapped_doors(walls: WallTable, fronts: Fronts, entrances: Entrances) -> facades.MappedDoors:
    """Find the walls of the doors that a map draws, but for those that are main doors already.

    Parameters
    ----------
    walls, fronts
        As `lay_out` takes them.
    """
    usable = fronts.grounded & (walls.length >= facades.MIN_WALL)
    usable &= walls.blind_to <= walls.z_low + 0.05
    wall, along = walls_at(walls, usable, entrances.places)
    main = fronts.door[wall] & (np.abs(along - fronts.door_along[wall]) < SAME_DOOR)
    more = np.flatnonzero(entrances.open & (wall >= 0) & ~main)
    without = np.flatnonzero(entrances.closed & (wall >= 0))
    return facades.MappedDoors(
        wall[more], entrances.role[more], along[more], wall[without], along[without]
    )


def _shops(
    city: City,
    part: IntArray,
    group: IntArray,
    mode: IntArray,
    worth: FloatArray,
    share: FloatArray,
    building: NDArray[np.uint64],
    least: FloatArray,
) -> NDArray[np.bool_]:
    """(w,) whether the ground floor behind a wall is let to shops; `least`, (n,), as of styles."""
    layout = city.layout
    owner, described = owner_rows(layout)
    place = np.full(len(layout.parts), "urban", "U8")
    if len(layout.buildings):
        place = np.where(described, layout.buildings["place"].to_numpy(str)[owner], place)
    use = landuse_of(layout)
    index = {name: number for number, name in enumerate(GROUPS)}
    share = share * np.select([place == "core", place == "urban"], [1.7, 1.0], 0.12)[part]
    share = np.where(np.isin(use, ["retail"])[part], np.maximum(share, 0.85), share)
    share = np.where(np.isin(use, ["commercial"])[part], np.maximum(share, 0.5), share)
    share = np.where((group == index["retail"])[part], 1.0, share)
    share = np.where((group == index["office"])[part], share * 0.8 + 0.05, share)
    no = np.isin(group, [index[name] for name in ("house", "industry", "worship", "civic", "shed")])
    share = np.where(no[part], 0.0, share)
    # What is only guessed to be a house, by its size, may be a shop in a town that has such.
    words = layout.buildings["use"].to_numpy(str)[owner] if len(layout.buildings) else place
    said = described & np.isin(words, list(GROUP_OF))
    open_ = ~no | ((group == index["house"]) & ~said)
    share = np.maximum(share, np.where(open_ & (place != "low"), least, 0.0)[part])
    share = np.where(_mapped_shops(layout, building), 1.0, share)
    fit = np.isin(mode, [facades.PUNCHED, facades.STRIP, facades.CURTAIN]) & (worth >= 2.0)
    return np.asarray(fit & (uniform(city.seed, "facade/shop", building) < share))


def _least_shops(style: Words) -> FloatArray:
    """Return the least share of shops of the style of each part, (n,)."""
    known, index = np.unique(style, return_inverse=True)
    table = np.array([looks()[name].facade.shops for name in known.tolist()], float)
    return np.asarray(table[index] if len(style) else np.zeros(0))


def _mapped_shops(layout: Layout, building: NDArray[np.uint64]) -> NDArray[np.bool_]:
    """(w,) whether the map has a shop within the building of a wall."""
    points = layout.points
    spots = points.geometry.to_numpy()[(points["kind"] == "shop").to_numpy()]
    if not len(spots) or not len(layout.buildings):
        return np.zeros(len(building), bool)
    tree = shapely.STRtree(layout.buildings.geometry.to_numpy())
    row = np.unique(tree.query(spots, predicate="intersects")[1])
    return np.isin(building, layout.buildings["id"].to_numpy(np.uint64)[row])


def trade_of(layout: Layout, seed: int) -> FloatArray:
    """Factor on the share of shops, (n,): up to 2 where a quarter of the buildings trade."""
    trading = np.isin(groups_of(layout, seed), [GROUPS.index("retail"), GROUPS.index("office")])
    if not trading.any():
        return np.ones(len(trading))
    centroid = shapely.centroid(layout.parts.geometry.to_numpy())
    middle = np.column_stack([shapely.get_x(centroid), shapely.get_y(centroid)])
    spots = shapely.points(np.nan_to_num(middle))
    # Not by scipy, whose import takes longer than a change of one building.
    tree = shapely.STRtree(spots)
    around, traders = np.zeros((2, len(spots)), np.int64)
    for first in range(0, len(spots), AT_ONCE):
        mine, other = tree.query(spots[first : first + AT_ONCE], "dwithin", QUARTER)
        around += np.bincount(mine + first, minlength=len(spots))
        traders += np.bincount(mine[trading[other]] + first, minlength=len(spots))
    return np.asarray(1 + 4 * np.minimum(traders / np.maximum(around, 1), 0.25))


def _sizes(
    designs: Designs, building: NDArray[np.uint64], part: IntArray, seed: int
) -> dict[str, FloatArray]:
    """Measures of bays and windows per wall, each building a little different."""
    names = designs.style
    wanted = ("bay", "sill", "ground_storey", "corner")
    table_of = {name: looks()[name].facade for name in np.unique(names).tolist()}
    rules = [table_of[name] for name in names.tolist()]
    drawn = [WINDOWS[name][1:] for name in designs.window.tolist()]
    table = {
        name: np.array([getattr(rule, name) for rule in rules], float)[part] for name in wanted
    }
    scale = np.array([rule.scale for rule in rules], float).reshape(-1, 2)[part]
    opening = np.array(drawn, float).reshape(-1, 2)[part]

    def vary(what: str, amount: float) -> FloatArray:
        return 1 + amount * (2 * uniform(seed, f"facade/{what}", building) - 1)

    table["width"] = opening[:, 0] * scale[:, 0] * vary("width", 0.08)
    table["height"] = opening[:, 1] * scale[:, 1] * vary("height", 0.09)
    shutters = np.where(designs.window[part] == "window_shuttered", 1.25, 0.0)
    table["bay"] = np.maximum(table["bay"] * vary("bay", 0.13), table["width"] + shutters + 0.45)
    table["sill"] = table["sill"] * vary("sill", 0.15)
    table["ground_storey"] = table["ground_storey"] * vary("ground", 0.08)
    return table


def _door_sizes(
    door: Words, seed: int, building: NDArray[np.uint64]
) -> tuple[FloatArray, FloatArray]:
    known, index = np.unique(door, return_inverse=True)
    table = np.array([DOORS[name][1:] for name in known.tolist()], float).reshape(-1, 2)
    size = table[index] if len(door) else np.zeros((0, 2))
    factor = 0.94 + 0.12 * uniform(seed, "facade/door", building)
    return size[:, 0] * factor, size[:, 1] * factor
