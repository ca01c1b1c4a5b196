"""Checks of bridges, ramps and tunnels: grades, clearance, and that nothing stands in a street."""

from __future__ import annotations

import numpy as np

from cityx.checks.check import Check
from cityx.city import City
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import arc_lengths, locate, values_along
from cityx.ground.standing import surfaces_at

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


def check_heights(city: City) -> list[Check]:
    """Run every check on the heights of ways; none where there is no network."""
    network = city.network
    if network is None or not network.edge_count:
        return []
    checks = [
        Check("grades_exceeded", steep_share(city), 0.01,
              "share of the length of streets that is steeper than its class may be")
    ]  # fmt: skip
    bodies = city.scene.meshes.get("structures")
    if bodies is not None and bodies.count:
        blocked, low, least = _headroom(city)
        checks += [
            Check("streets_blocked", blocked, 0,
                  "places on carriageways where a bridge or a wall stands"),
            Check("clearance_short", low, 0,
                  f"places on carriageways with less than {CLEAR} m of free height"),
            Check("clearance_least", least, CLEAR - NEARLY,
                  "least free height over a carriageway, metres", at_least=True),
        ]  # fmt: skip
    return checks


def steep_share(city: City) -> float:
    """Return the share of the length of streets that exceeds the grade of its class."""
    network = city.network
    if network is None or not network.edge_count:
        return 0.0
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
    steep = np.abs(end - begin) / np.maximum(run, 0.01) > limit[edge] + SLACK
    return float(run[steep].sum() / max(run.sum(), 1e-9))


def _headroom(city: City) -> tuple[int, int, float]:
    """Find places on carriageways that are inside a body, or that lack clearance under one."""
    xy, z = carriageway_places(city)
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
