"""Checks of bridges, ramps and tunnels: grades, clearance, and that nothing stands in a street."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from cityx.checks.check import Check
from cityx.city import City
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.clearance import near_any
from cityx.geometry.polylines import arc_lengths, locate, values_along
from cityx.ground.standing import surfaces_at
from cityx.system.remembered import Remembered

# Steepest climb by kind of way, as standards for streets of towns in hills have it; rails last.
LIMITS = {"motorway": 0.06, "trunk": 0.07, "primary": 0.08, "secondary": 0.09, "tertiary": 0.10,
          "service": 0.15, "track": 0.18}  # fmt: skip
USUAL_LIMIT = 0.12
LINK_MORE = 0.02  # on ramps between roads, where one drives slowly
SLACK = 0.005  # of a grade, which rounding and evening out take
# Metres over which a grade is measured: the ground meets its profile to 2.5 cm at 95 % of stations,
# which over the five metres between two of them is as much as the slack.
RUN = 10.0
EVERY = 2.0  # metres between the places that are looked at
HEAD = 1.0  # metres above a carriageway at which nothing solid may stand
CLEAR = 4.5  # metres of free height over a carriageway
NEARLY = 0.05  # metres
RAISED = 0.05  # metres from the ground from which a street is a ramp
BESIDE = 8.0  # metres, about half the widths of two streets
PAIR = re.compile(r"(\S+/\d+) x (\S+/\d+)")  # of ways, in notes
# What notes say of ways that cross and have no room (`cityx.road.network.contradictions`).
TOLD = ("without room", "for want of room", "are one surface")
ROOMLESS = 25.0  # metres round a crossing without room, about the width of two streets
STEEPEST = 2.5  # times the grade that ramps without room may climb
STEEPENED = 80.0  # metres round a crossing within which ways climb more for want of room


def check_heights(city: City) -> list[Check]:
    """Run every check on the heights of ways; none where there is no network."""
    network = city.network
    if network is None or not network.edge_count:
        return []
    crossings = crossings_of(city)
    share, ramps = steep_streets(city, crossings)
    left = f"; left out for want of room: ramps of {', '.join(ramps)}" if ramps else ""
    checks = [
        Check("grades_exceeded", share, 0.01,
              "share of the length of streets that is steeper than its class may be; ramps within "
              f"{STEEPENED:g} m of crossings for which the map leaves no room may be up to "
              f"{STEEPEST:g} times as steep{left}")
    ]  # fmt: skip
    bodies = city.scene.meshes.get("structures")
    if bodies is not None and bodies.count:
        blocked, low, least = _headroom(city, crossings)
        apart = "" if not len(crossings.roomless) else (
            f"; around {len(crossings.roomless)} crossings, for which the map leaves no room, none "
            f"is counted: {', '.join(crossings.pairs)}"
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


@dataclass(frozen=True)
class MapCrossings:
    """Where streets of the map pass over each other without room for it.

    Attributes
    ----------
    roomless
        (k, 2) metres, where the city names the map's ways as having no room for it.
    pairs
        Names of the ways of these.
    """

    roomless: FloatArray
    pairs: tuple[str, ...]

    def spare(self, xy: FloatArray) -> BoolArray:
        """(n,) whether places lie around a crossing for which the map leaves no room."""
        return near_any(xy, shapely.points(self.roomless), ROOMLESS)


_LAST: Remembered[MapCrossings] = Remembered()


def crossings_of(city: City) -> MapCrossings:
    """Find where the city says that streets pass over each other without room for it."""
    network, layout = city.network, city.layout
    assert network is not None
    told = sorted({
        (one, other)
        for note in city.notes if any(words in note for words in TOLD)
        for one, other in PAIR.findall(note)
    })  # fmt: skip

    def made() -> MapCrossings:
        ways: dict[str, list[Any]] = {}
        roads = layout.roads
        for name, line in zip(roads["source"], roads.geometry, strict=True):
            ways.setdefault(name, []).append(line)
        spots = [np.zeros((0, 2))]
        for pair in told:
            mine, theirs = (shapely.union_all(ways.get(name, [])) for name in pair)
            reach = shapely.buffer(theirs, BESIDE)
            spots.append(shapely.get_coordinates(
                shapely.segmentize(shapely.intersection(mine, reach), BESIDE)
            ))  # fmt: skip
        return MapCrossings(np.concatenate(spots), tuple(" x ".join(pair) for pair in told))

    return _LAST.get(made, [layout, network], city.notes)


def steep_share(city: City) -> float:
    """Return the share of the length of streets that exceeds the grade of its class."""
    return steep_streets(city, None)[0]


def steep_streets(city: City, crossings: MapCrossings | None) -> tuple[float, tuple[str, ...]]:
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
    limit = np.array([LIMITS.get(word.removesuffix("_link"), USUAL_LIMIT) for word in kind])
    limit += LINK_MORE * np.char.endswith(kind, "_link")
    grade = np.abs(end - begin) / np.maximum(run, 0.01)
    steep = grade > limit[edge] + SLACK
    ramps: tuple[str, ...] = ()
    if crossings is not None:
        rows = np.flatnonzero(steep & (grade < STEEPEST * limit[edge] + SLACK))
        ends = [(number[rows] + k) * run[rows] for k in (0, 1)]
        lift = [values_along(lines, network.lift, edge[rows], along) for along in ends]
        middle = locate(lines, edge[rows], (ends[0] + ends[1]) / 2)[0]
        ramp = np.abs(np.stack(lift)).max(axis=0) > RAISED
        ramp &= near_any(middle, shapely.points(crossings.roomless), STEEPENED)
        steep[rows[ramp]] = False
        source = city.layout.roads["source"].to_numpy().astype(str)
        ramps = tuple(np.unique(source[network.edge_road[edge[rows[ramp]]]]).tolist())
    return float(run[steep].sum() / max(run.sum(), 1e-9)), ramps


def _headroom(city: City, crossings: MapCrossings) -> tuple[int, int, float]:
    """Find places on carriageways that are inside a body, or that lack clearance under one."""
    xy, z = carriageway_places(city)
    counted = ~crossings.spare(xy)
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


def carriageway_places(city: City, period: float = EVERY) -> tuple[FloatArray, FloatArray]:
    """Return places on the middle of carriageways and of their halves, (k, 2) and (k,) metres.

    One lies in every `period` metres.
    """
    network = city.network
    assert network is not None
    lines = network.lines
    length = arc_lengths(lines)[1]
    count = np.maximum((length / period).astype(int), 1)
    edge = np.repeat(np.arange(lines.count), count)
    first = np.concatenate([[0], np.cumsum(count)])[:-1]
    along = (np.arange(len(edge)) - first[edge] + 0.5) * (length / count)[edge]
    at, ahead = locate(lines, edge, along)
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]]) * (network.half_width[edge] / 2)[:, None]
    z = values_along(lines, network.z, edge, along)
    return np.concatenate([at, at + left, at - left]), np.tile(z, 3)


def _above(city: City, xy: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return where vertical lines through places meet the bodies: place and height of each."""
    # Moved by less than anything built, so that no line runs through an edge two faces share.
    return surfaces_at(city.scene.meshes["structures"], xy + np.array([1.7e-5, 2.9e-5]))
