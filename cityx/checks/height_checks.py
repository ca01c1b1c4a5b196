"""Checks of bridges, ramps and tunnels: grades, clearance, and that nothing stands in a street."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.checks.check import Check
from cityx.checks.level_room import (
    CLEAR,
    STEEPEST,
    LevelCrossings,
    grade_limits,
    level_crossings,
)
from cityx.city import City
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.clearance import near_any
from cityx.geometry.polylines import arc_lengths, locate, to_linestrings, values_along
from cityx.ground.standing import surfaces_at
from cityx.ids import id_text

SLACK = 0.005  # of a grade, which rounding and evening out take
# Metres over which a grade is measured: the ground meets its profile to 2.5 cm at 95 % of stations,
# which over the five metres between two of them is as much as the slack.
RUN = 10.0
EVERY = 2.0  # metres between the places that are looked at
HEAD = 1.0  # metres above a carriageway at which nothing solid may stand
NEARLY = 0.05  # metres
RAISED = 0.05  # metres from the ground from which a street is a ramp
ROOMLESS = 25.0  # metres round a crossing without room, about the width of two streets
NAMED_WITHIN = 1.0  # metres from a crossing within which both of its streets are found
STEEPENED = 80.0  # metres round a crossing within which ways climb more for want of room


def check_heights(city: City) -> list[Check]:
    """Run every check on the heights of ways; none where there is no network."""
    network = city.network
    if network is None or not network.edge_count:
        return []
    crossings = level_crossings(city.layout)
    share, ramps = steep_streets(city, crossings)
    left = f"; left out for want of room: ramps of {', '.join(ramps)}" if ramps else ""
    closed, pairs = _closed(city, crossings)
    checks = [
        Check("levels_closed", float(closed), 0,
              f"crossings of streets with less than {CLEAR} m between the levels, though the map "
              "leaves room for more", ids=pairs),
        Check("grades_exceeded", share, 0.01,
              "share of the length of streets that is steeper than its class may be; ramps within "
              f"{STEEPENED:g} m of crossings for which the map leaves no room may be up to "
              f"{STEEPEST:g} times as steep{left}")
    ]  # fmt: skip
    bodies = city.scene.meshes.get("structures")
    if bodies is not None and bodies.count:
        blocked, low, least = _headroom(city)
        apart = "" if not crossings.roomless.any() else (
            f"; around {int(crossings.roomless.sum())} crossings, for which the map leaves no "
            f"room, none is counted: {', '.join(_pairs(city, crossings.roomless, crossings))}"
        )  # fmt: skip
        checks += [
            Check("streets_blocked", blocked, 0,
                  f"places on carriageways where a bridge or a wall stands{apart}"),
            Check("clearance_short", low, 0,
                  f"places on carriageways with less than {CLEAR} m of free height{apart}"),
            Check("clearance_least", least, CLEAR - NEARLY,
                  "least free height over a carriageway, metres", at_least=True),
        ]  # fmt: skip
    return checks


def without_room(city: City, xy: FloatArray) -> BoolArray:
    """(n,) whether places lie around a crossing for which the map leaves no room."""
    crossings = level_crossings(city.layout)
    return near_any(xy, shapely.points(crossings.at[crossings.roomless]), ROOMLESS)


def _pairs(city: City, rows: BoolArray, crossings: LevelCrossings) -> tuple[str, ...]:
    """Name the ways of some crossings, each pair once, the upper first."""
    source, ids = (city.layout.roads[name].to_numpy() for name in ("source", "id"))
    pairs = np.unique(np.column_stack([crossings.upper, crossings.lower])[rows], axis=0)
    return tuple(" x ".join(str(source[way]) or id_text(int(ids[way])) for way in pair)
                 for pair in pairs.tolist())  # fmt: skip


def _closed(city: City, crossings: LevelCrossings) -> tuple[int, tuple[str, ...]]:
    """Count crossings of streets whose levels lie too near to each other; name their ways."""
    network = city.network
    assert network is not None
    lines, shapes = network.lines, to_linestrings(network.lines)
    spots = shapely.points(crossings.at)
    spot, edge = shapely.STRtree(shapes).query(spots, "dwithin", distance=NAMED_WITHIN)
    along = shapely.line_locate_point(shapes[edge], spots[spot])
    z = values_along(lines, network.z, edge, along)
    height = np.full((2, len(spots)), np.nan)
    road = network.edge_road[edge]
    upper, lower = (road == way[spot] for way in (crossings.upper, crossings.lower))
    np.fmax.at(height[0], spot[upper], z[upper])
    np.fmin.at(height[1], spot[lower], z[lower])
    short = (height[0] - height[1] < CLEAR) & ~crossings.roomless
    return int(short.sum()), _pairs(city, short, crossings)


def steep_share(city: City) -> float:
    """Return the share of the length of streets that exceeds the grade of its class."""
    return steep_streets(city, None)[0]


def steep_streets(city: City, crossings: LevelCrossings | None) -> tuple[float, tuple[str, ...]]:
    """Return the share of the length of streets that exceeds the grade of its class.

    Parameters
    ----------
    city
        The city.
    crossings
        Of its map: ramps round them are left out, steep as they are for want of room.

    Returns
    -------
    share
        Of the length of all streets.
    ramps
        Names of the streets that were left out.
    """
    network = city.network
    if network is None or not network.edge_count:
        return 0.0, ()
    lines = network.lines
    length = arc_lengths(lines)[1]
    count = np.maximum((length / RUN).astype(int), 1)
    edge = np.repeat(np.arange(lines.count), count)
    run = (length / count)[edge]
    number = np.arange(len(edge)) - np.searchsorted(edge, edge)
    begin, end = (values_along(lines, network.z, edge, k * run) for k in (number, number + 1))
    kind = city.layout.roads["kind"].to_numpy().astype(str)[network.edge_road]
    limit = grade_limits(kind)
    grade = np.abs(end - begin) / np.maximum(run, 0.01)
    steep = grade > limit[edge] + SLACK
    ramps: tuple[str, ...] = ()
    if crossings is not None:
        rows = np.flatnonzero(steep & (grade < STEEPEST * limit[edge] + SLACK))
        ends = [(number[rows] + k) * run[rows] for k in (0, 1)]
        lift = [values_along(lines, network.lift, edge[rows], along) for along in ends]
        middle = locate(lines, edge[rows], (ends[0] + ends[1]) / 2)[0]
        ramp = np.abs(np.stack(lift)).max(axis=0) > RAISED
        ramp &= near_any(middle, shapely.points(crossings.at[crossings.tight]), STEEPENED)
        steep[rows[ramp]] = False
        source = city.layout.roads["source"].to_numpy().astype(str)
        ramps = tuple(np.unique(source[network.edge_road[edge[rows[ramp]]]]).tolist())
    return float(run[steep].sum() / max(run.sum(), 1e-9)), ramps


def _headroom(city: City) -> tuple[int, int, float]:
    """Find places on carriageways that are inside a body, or that lack clearance under one."""
    xy, z = carriageway_places(city)
    counted = ~without_room(city, xy)
    xy, z = xy[counted], z[counted]
    hit, height = _above(city, xy)
    above = height - z[hit]
    inside = np.bincount(hit[above > HEAD], minlength=len(xy)) % 2 == 1
    free = np.full(len(xy), np.inf)
    high = above > HEAD
    np.minimum.at(free, hit[high], above[high])
    free[inside] = np.inf  # counted as blocked
    short = free < CLEAR - NEARLY
    least = float(free.min(initial=np.inf))
    return int(inside.sum()), int(short.sum()), least if np.isfinite(least) else 99.0


def carriageway_places(
    city: City, period: float = EVERY, *, without: tuple[str, ...] = ()
) -> tuple[FloatArray, FloatArray]:
    """Return places on the middle of carriageways and of their halves, (k, 2) and (k,) metres.

    One lies in every `period` metres; ways of the kinds `without` have none.
    """
    network = city.network
    assert network is not None
    lines = network.lines
    length = arc_lengths(lines)[1]
    count = np.maximum((length / period).astype(int), 1)
    kind = city.layout.roads["kind"].to_numpy().astype(str)[network.edge_road]
    count[np.isin(kind, without)] = 0
    edge = np.repeat(np.arange(lines.count), count)
    first = np.concatenate([[0], np.cumsum(count)])[:-1]
    along = (np.arange(len(edge)) - first[edge] + 0.5) * (length / np.maximum(count, 1))[edge]
    at, ahead = locate(lines, edge, along)
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]]) * (network.half_width[edge] / 2)[:, None]
    z = values_along(lines, network.z, edge, along)
    return np.concatenate([at, at + left, at - left]), np.tile(z, 3)


def _above(city: City, xy: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return where vertical lines through places meet the bodies: place and height of each."""
    # Moved by less than anything built, so that no line runs through an edge two faces share.
    return surfaces_at(city.scene.meshes["structures"], xy + np.array([1.7e-5, 2.9e-5]))
