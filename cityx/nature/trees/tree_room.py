"""The room a tree has between walls, carriageways and lamps, and how large it may grow there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Frame
from cityx.city.ground import PAINT
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.clearance import Spots, distance_within, near_any, push_off, spots_of
from cityx.geometry.polylines import to_linestrings
from cityx.ground.pieces import room_along, walk_rims
from cityx.ground.standing import WALKED
from cityx.places.profiles import profile_of

KERB_CLEARANCE = 0.8  # metres from trunk to kerb
FACADE_CLEARANCE = 2.5  # metres from trunk to facade for trees nobody mapped
LEAST_FACADE = 0.6  # metres, the same for mapped ones: they are where they are
LAMP_CLEARANCE = 4.0  # metres from a lamp for trees nobody mapped
SIGHT = 8.0  # metres kept free beyond a junction's arms, so that drivers see each other
DRIVEWAY_SIGHT = 2.5  # metres, the same beside driveways, out of which cars creep
DRIVEWAYS = ("service", "track")
MAPPED_SIGHT = 0.6  # metres, the same for mapped ones: what stands there hides little
# Metres a mapped tree may be moved out of a carriageway: kerbs are drawn as bays and narrowings
# let them, and trees between bays stand as far out as a car is broad.
MOST_PUSH = 3.3
CROWN_REACH = 7.0  # metres, the widest crown
ROAD_HEADROOM = 4.5  # metres below branches over a carriageway
WALK_REACH = 2.0  # metres from a path within which trees are pruned as beside a street
OVERHANG = 1.6  # metres a low crown may reach over a kerb: its rim hangs higher than its foot
FREE_LEAVES = 0.15  # metres between a crown and a facade
FROM_WIRES = 8.0  # metres from the middle of a power line: crowns grow into wires, and fall on them
# Metres round things that need free air: blades, masts, what lands.
FREE_AIR = {"helipad": 16.0, "wind_turbine": 12.0, "power_tower": 8.0, "crane": 6.0}
LEAST_KERB = 0.45  # metres from trunk to kerb of mapped trees on narrow walks
LEAST_PASS = 1.45  # metres of walk from the middle of a mapped trunk, on its wider side
PATH_GAP = 0.3  # metres between a mapped trunk and a path through a park
RAYS = 16  # directions in which the walk about a trunk is measured
LEAST_WIDTH = 0.1  # share of its grown width to which a crown beside a wall is drawn in at most
TALLEST = 2.3  # height over width, as shares of the grown tree, of a crown in a narrow place
# Surfaces of the ground on which no trunk stands, whatever the map says.
TREELESS = (
    "carriageway",
    "setts",
    "gutter",
    "parking_lane",
    "mouth_setts",
    "junction",
    *PAINT,
    "tramway",
    "water",
)
WATER = ("water", "sea", "river", "pool")
OPEN_AREAS = (*WATER, "pitch", "parking", "road_area", "railway", "playground", "pier",
              "construction", "farmland", "sand")  # fmt: skip


@dataclass(frozen=True)
class Room:
    """What surrounds trees, (n,) each; inf beyond `CROWN_REACH`.

    Attributes
    ----------
    facade
        Metres to the nearest facade.
    road
        Metres to the nearest carriageway.
    path
        Metres to the nearest path.
    """

    facade: FloatArray
    road: FloatArray
    path: FloatArray


@dataclass(frozen=True)
class Custom:
    """Distances that trees without a mapped place keep, metres from the trunk.

    Attributes
    ----------
    kerb, facade, lamp
        To each of these.
    sight
        To the arms of a junction, so that drivers see each other.
    """

    kerb: float = KERB_CLEARANCE
    facade: float = FACADE_CLEARANCE
    lamp: float = LAMP_CLEARANCE
    sight: float = SIGHT


# Of rows of clipped trees in pits right behind the kerb, with high stems.
CLIPPED = Custom(kerb=0.5, facade=1.9, lamp=2.5, sight=5.0)


def custom_of(frame: Frame) -> Custom:
    """Return how near to things a place plants its trees."""
    return CLIPPED if profile_of(frame).trees.clipped else Custom()


def sight_at(city: City) -> FloatArray:
    """(n,) metres kept free of trees behind the arms of each node, 0 where a street goes on."""
    network = city.network
    assert network is not None
    kind = city.layout.roads["kind"].to_numpy().astype(str)[network.edge_road]
    streets = network.edge_nodes[~np.isin(kind, DRIVEWAYS)].ravel()
    arms = np.bincount(streets, minlength=len(network.node_position))
    custom = custom_of(city.frame)
    other = np.where(network.node_degree > 2, min(DRIVEWAY_SIGHT, custom.sight), 0.0)
    return np.asarray(np.where(arms > 2, custom.sight, other))


def room_of(
    city: City, xy: FloatArray, mapped: BoolArray, lamps: FloatArray,
    street: BoolArray | None = None,
) -> tuple[FloatArray, BoolArray, Room]:  # fmt: skip
    """Move mapped trees off carriageways and find which trees may stand.

    Parameters
    ----------
    city
        The city.
    xy
        (n, 2) float, metres.
    mapped
        (n,) bool, trees of the map, which get more tolerance.
    lamps
        (m, 2) float, places of street lamps.
    street
        (n,) bool, trees for which room on a walk is measured already; footways drawn along it are
        part of it. None for none.

    Returns
    -------
    xy, keep, room
        Places after moving, which of them are free, and the room of all.
    """
    areas = city.layout.areas
    kinds = areas["kind"].to_numpy().astype(str)
    shapes = areas.geometry.to_numpy()
    houses = city.layout.buildings.geometry.to_numpy()
    before = spots_of(xy)
    keep = ~near_any(before, shapes[np.isin(kinds, WATER)], 0.5)
    keep &= mapped | ~near_any(before, shapes[np.isin(kinds, OPEN_AREAS)], 0.5)
    lines, half, driven = _strips(city)
    custom = custom_of(city.frame)
    moved, free = push_off(before, lines, half + custom.kerb, most=MOST_PUSH)
    if street is not None and street.any():
        moved[street] = xy[street]
        free[street] = ~near_any(xy[street], lines[driven], half[driven] + custom.kerb)
    moved, free = _beside_walks(city, moved, free, before, mapped, (lines, half, driven))
    keep &= free & (mapped | (np.hypot(*(moved - xy).T) < 1e-9))
    spots = spots_of(moved) if (moved != xy).any() else before
    facade = distance_within(spots, houses, CROWN_REACH)
    keep &= facade > np.where(mapped, LEAST_FACADE, custom.facade)
    if city.network is not None:
        network = city.network
        arms = network.edge_nodes.ravel()
        radius = np.zeros(len(network.node_position))
        np.maximum.at(radius, arms, np.repeat(network.half_width, 2))
        joint = network.node_degree >= 3
        nodes = shapely.points(network.node_position[joint])
        keep &= ~near_any(spots, nodes, radius[joint] + MAPPED_SIGHT)
        keep &= mapped | ~near_any(spots, nodes, radius[joint] + sight_at(city)[joint])
    keep &= mapped | ~_in_the_air(city, spots)
    if len(lamps):
        keep &= mapped | ~near_any(spots, shapely.points(lamps), custom.lamp)
    if city.ground is not None:
        ground = city.ground
        keep &= ~ground.on(moved, *TREELESS)
    road = _gap(spots, lines[driven], half[driven])
    path = _gap(spots, lines[~driven], half[~driven])
    return moved, keep, Room(facade, road, path)


def _in_the_air(city: City, spots: Spots) -> BoolArray:
    """(n,) whether a tree would grow into wires, or where something flies or turns."""
    lines, points = city.layout.lines, city.layout.points
    wires = lines.geometry.to_numpy()[(lines["kind"] == "power_line").to_numpy()]
    found = near_any(spots, wires, FROM_WIRES)
    for kind, metres in FREE_AIR.items():
        found |= near_any(spots, points.geometry.to_numpy()[(points["kind"] == kind).to_numpy()],
                          metres)  # fmt: skip
    return found


def _beside_walks(
    city: City,
    moved: FloatArray,
    free: BoolArray,
    before: Spots,
    mapped: BoolArray,
    strips: tuple[NDArray[Any], FloatArray, BoolArray],
) -> tuple[FloatArray, BoolArray]:
    """Move mapped trees that a footway crowds onto the walk, where pedestrians can pass them.

    Footways beside a street are drawn as lines of their own; trees of their walks, which reach to
    the kerb, would be pushed from the one strip into the other and back.
    """
    lines, half, driven = strips
    rows = np.flatnonzero(mapped & ~(free & _clear_of_walls(city, moved)))
    if not len(rows) or city.ground is None:
        return moved, free
    kerb = custom_of(city.frame).kerb
    walls = walk_rims(city.ground)
    moved, free = moved.copy(), free.copy()
    # Nearer to the kerb where the walk is too narrow for the usual distance.
    for gap in (kerb, LEAST_KERB):
        xy, clear = push_off(before.xy[rows], lines[driven], half[driven] + gap, most=MOST_PUSH)
        walked = city.ground.on(xy, *WALKED)
        way = _passed(xy, walls) >= LEAST_PASS
        paths = near_any(xy, lines[~driven], half[~driven] + PATH_GAP)
        clear &= _clear_of_walls(city, xy) & np.where(walked, way, ~paths)
        moved[rows[clear]], free[rows[clear]] = xy[clear], True
        rows = rows[~clear]
        if not len(rows):
            break
    return moved, free


def _clear_of_walls(city: City, xy: FloatArray) -> BoolArray:
    houses = city.layout.buildings.geometry.to_numpy()
    return ~near_any(xy, houses, LEAST_FACADE)


def _passed(xy: FloatArray, rims: NDArray[Any]) -> FloatArray:
    """(n,) metres of walk beside trunks, on the wider side of each."""
    angle = np.arange(RAYS) * 2 * np.pi / RAYS
    out = np.column_stack([np.cos(angle), np.sin(angle)])
    reach = room_along(np.repeat(xy, RAYS, axis=0), np.tile(out, (len(xy), 1)), rims, 4.0)
    # Across the walk, the direction in which it is narrowest, one passes on one side or the other.
    both = reach.reshape(-1, 2, RAYS // 2)
    across = np.argmin(both.sum(axis=1), axis=1)
    found = np.take_along_axis(both, across[:, None, None], axis=2)[..., 0]
    return np.asarray(found.max(axis=1))


def _gap(spots: Spots, lines: NDArray[Any], half: FloatArray) -> FloatArray:
    """(n,) metres from points to the edge of the nearest strip, inf beyond `CROWN_REACH`."""
    gap = np.full(len(spots.xy), np.inf)
    if len(lines) and len(gap):
        line, spot = spots.tree.query(lines, predicate="dwithin", distance=half + CROWN_REACH)
        distance = shapely.distance(spots.points[spot], lines[line]) - half[line]
        np.minimum.at(gap, spot, distance)
    return gap


def _strips(city: City) -> tuple[NDArray[Any], FloatArray, BoolArray]:
    """Centrelines of everything one moves on, half widths, and which of them carry vehicles."""
    roads = city.layout.roads
    kind = roads["kind"].to_numpy().astype(str)
    shapes = roads.geometry.to_numpy()
    half = roads["width"].to_numpy() / 2
    rail = np.isin(kind, ("rail", "light_rail", "tram"))
    half = np.where(rail, np.fmax(half, 2.6), np.where(np.isfinite(half), half, 1.0))
    driven = ~np.isin(kind, ("footway", "path", "cycleway", "steps", "pedestrian", "track",
                             "bridleway", "corridor", "platform"))  # fmt: skip
    here = ~roads["tunnel"].to_numpy() & (kind != "subway")
    if city.network is None or not city.network.edge_count:
        return shapes[here], half[here], driven[here]
    # The network knows narrowed widths; the layout still has paths and rails.
    used = np.zeros(len(roads), bool)
    used[city.network.edge_road] = True
    rest = here & ~used
    lines = to_linestrings(city.network.lines)
    return (np.concatenate([shapes[rest], lines]),
            np.concatenate([half[rest], city.network.half_width]),
            np.concatenate([driven[rest], driven[city.network.edge_road]]))  # fmt: skip


def beside_street(room: Room) -> BoolArray:
    """(n,) trees whose branches must leave headroom."""
    return (room.road < CROWN_REACH - 2.0) | (room.path < WALK_REACH)


def fitted(
    up: FloatArray, wide: FloatArray, size: FloatArray, room: Room, *, fixed: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Fit trees into their room.

    Parameters
    ----------
    up, wide
        (n,) wished scale of height and of width.
    size
        (n, 4) float, metres: height, crown radius, clear stem and reach towards a wall of the
        grown plants.
    room
        Of the trees.
    fixed
        (n,) bool, trees whose height is mapped.

    Returns
    -------
    up, wide
        Scales: crowns end before facades; over a carriageway they leave `ROAD_HEADROOM`, or hardly
        reach it.
    """
    _, reach, clear, to_wall = size.T
    wide = np.minimum(wide, np.maximum((room.facade - FREE_LEAVES) / to_wall, LEAST_WIDTH))
    up = np.minimum(up, TALLEST * wide)
    over = wide * reach > room.road + 0.3
    need = np.where(clear > 0, ROAD_HEADROOM / np.maximum(clear, 0.1), np.inf)
    raise_ = over & (up < need) & (need <= np.where(fixed, 1.15, 1.4) * up)
    raise_ &= need <= TALLEST * wide
    up = np.where(raise_, need, up)
    low = over & (clear * up < ROAD_HEADROOM - 1e-6)
    narrow = np.maximum((np.maximum(room.road, 0.0) + OVERHANG) / reach, up / TALLEST)
    return up, np.where(low, np.minimum(wide, narrow), wide)
