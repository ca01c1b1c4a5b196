"""One run on the streets of a city: network, simulation and tracks, in a folder of its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.signals import STATE, Signals, crossing_ids
from cityx.city.tracks import MOVER, MOVER_KINDS, Tracks, between, held_at
from cityx.geometry.arrays import FloatArray
from cityx.ids import hash_ids, id_text
from cityx.traffic.kinds import DRIVING
from cityx.traffic.network import Network, make_network
from cityx.traffic.recording import Mover, recorded
from cityx.traffic.simulation import Ghosts, Look, Outcome, Run, simulate, type_text
from cityx.traffic.streets import Streets

# Recorded movers of a city as obstacles of a new run.


HELD = 5.0  # seconds before the tracks begin in which everything is already where it begins
NEAR_CROSSING = 1.0  # metres from a crossing at which vehicles wait for who is about to walk
# Letter of SUMO -> what is shown.
LETTERS = {
    "r": "red", "u": "red_yellow", "y": "yellow", "Y": "yellow", "g": "green_yielding",
    "G": "green", "s": "green_yielding", "o": "off", "O": "off",
}  # fmt: skip
_Head = tuple[int, int, int, FloatArray, float, str, int]  # lane, onto, crossing, at, heading, ...


def ghosts_of(tracks: Tracks | None, streets: Streets, network: Network, run: Run) -> Ghosts | None:
    """Return movers as obstacles of a run; None for nothing.

    Of people those are kept who walk over crossings: nobody drives where the others walk.
    """
    if tracks is None:
        return None
    driven = np.isin(tracks.kind, [MOVER[kind] for kind in DRIVING])
    walks = tracks.kind == MOVER["pedestrian"]
    tracks = tracks.take(driven | walks)
    if not tracks.count:
        return None
    walks = tracks.kind == MOVER["pedestrian"]
    looks = [_look(tracks, row) for row in range(tracks.count)]
    types = sorted({type_text(look) for look in looks if look is not None})
    # Of crossings that the network has left out SUMO knows nothing.
    held = sorted((number, edge) for edge, number in network.crossings.items())
    crossings = [streets.crossings[number] for number, _ in held]
    areas = [shapely.LineString(crossing.shape[:, :2]).buffer(crossing.width / 2 + NEAR_CROSSING)
             for crossing in crossings]  # fmt: skip
    tree = shapely.STRtree(areas)
    steps = round((run.warm + run.duration) / run.step) + 1
    first = round((run.warm - HELD) / run.step)
    parts: list[FloatArray] = []
    start = np.zeros(steps + 1, np.int64)
    for step in range(steps):
        if step >= first:
            found = _at(tracks, walks, tree, max(0.0, step * run.step - run.warm))
            parts.append(found)
            start[step + 1] = start[step] + len(found)
    rows = np.concatenate([np.zeros((0, 5)), *parts])
    edges = np.array([edge for _, edge in held] or [""])
    return Ghosts(
        np.array([f"g{id_text(own)}" for own in tracks.object_id.tolist()]),
        np.array([look.type_name if look is not None else "" for look in looks]),
        tuple(types), start, rows[:, 0].astype(np.int64), rows[:, 1], rows[:, 2], rows[:, 3],
        rows[:, 4].astype(np.int64), edges,
    )  # fmt: skip


def _look(tracks: Tracks, row: int) -> Look | None:
    kind = MOVER_KINDS[tracks.kind[row]]
    if kind not in DRIVING:
        return None
    length, width, height = map(float, tracks.size[row])
    return Look(f"ghost_{tracks.look[row]}", kind, (length, width, height))


def _at(
    tracks: Tracks, walks: NDArray[np.bool_], tree: shapely.STRtree, moment: float
) -> FloatArray:
    """(p, 5) rows, foremost points, compass angles and crossings of those there at a moment."""
    row, low, high = held_at(tracks, moment)
    _, position, heading = between(tracks, low, high, moment)
    ahead = np.column_stack([np.cos(heading), np.sin(heading)])
    on_foot = walks[row]
    reach = np.where(on_foot, 0.0, tracks.size[row, 0] / 2)
    xy = position[:, :2] + ahead * reach[:, None]
    crossing = np.full(len(xy), -1, np.int64)
    if len(tree.geometries) and on_foot.any():
        person, area = tree.query(shapely.points(xy), predicate="intersects")
        crossing[person] = area
    kept = ~on_foot | (crossing >= 0)
    angle = np.mod(90.0 - np.degrees(heading), 360.0)
    columns = (row, xy[:, 0], xy[:, 1], angle, np.maximum(crossing, 0))
    return np.column_stack(columns)[kept]


@dataclass(frozen=True)
class Driven:
    """What a run on the streets of a city came to.

    Attributes
    ----------
    tracks
        Of the movers.
    signals
        What signals show meanwhile.
    outcome
        As the engine tells it.
    """

    tracks: Tracks
    signals: Signals | None
    outcome: Outcome


def driven(
    city: City, streets: Streets, run: Run, movers: Mapping[str, Mover], origin: str,
    others: Tracks | None,
) -> Driven:  # fmt: skip
    """Simulate a run on the streets of a city, among what moves there already.

    That drives and walks as it did before: those of this run give way.

    Parameters
    ----------
    city, streets
        The city and its streets.
    run
        Who sets out.
    movers
        What is seen of those whose tracks are kept, by name.
    origin
        Id of the action that puts them there.
    others
        What moves there already, None for nothing.

    Raises
    ------
    InputError
        If nothing drives in the city.
    MissingExtra, EngineError
        If SUMO is absent, refuses the streets or fails.
    """
    with TemporaryDirectory(prefix="cityx-traffic-") as name:
        network = make_network(streets, city.frame, Path(name), said=street_names(city))
        ghosts = ghosts_of(others, streets, network, run)
        outcome = simulate(run, network, ghosts)
        signals = signals_of(city, streets, network, run.warm)
    tracks = recorded(city, streets, network, outcome.poses, movers, origin, others)
    return Driven(tracks, signals, outcome)


def street_names(city: City) -> Callable[[str], str]:
    """Return what says of the id of an edge which street it is."""
    network, roads = city.network, city.layout.roads
    assert network is not None
    names = map(id_text, network.edge_id.tolist())
    rows = dict(zip(names, network.edge_road.tolist(), strict=True))

    def said(edge: str) -> str:
        if edge not in rows:
            return "no street of the city"
        road = roads.iloc[rows[edge]]
        return " ".join(str(word) for word in (road["kind"], road["name"], road["source"]) if word)

    return said


def signals_of(city: City, streets: Streets, network: Network, begin: float) -> Signals | None:
    """Return what signals show; None without any.

    Parameters
    ----------
    city, streets, network
        The city, its streets and the network made of them.
    begin
        Seconds of the simulation at which the tracks begin.
    """
    from lxml import etree

    root = etree.parse(network.file, etree.XMLParser(huge_tree=True)).getroot()
    plans = {
        plan.get("id"): [(float(p.get("duration")), p.get("state")) for p in plan.findall("phase")]
        for plan in root.iter("tlLogic")
    }
    delay = {plan.get("id"): float(plan.get("offset")) for plan in root.iter("tlLogic")}
    heads = _vehicle_heads(city, streets, network, root) + _walker_heads(city, streets, root,
                                                                         network)  # fmt: skip
    if not heads:
        return None
    told = [_shown(plans[plan], index, begin - delay[plan]) for *_, plan, index in heads]
    lane, onto, crossing = (
        np.array([head[column] for head in heads], np.uint64) for column in range(3)
    )
    ids = hash_ids(0, "signal", lane ^ crossing, onto)
    order = np.argsort(ids)
    changes = [told[row] for row in order.tolist()]
    start = np.concatenate([[0], np.cumsum([len(times) for _, times, _ in changes])])
    return Signals(
        ids[order], lane[order], onto[order], crossing[order],
        np.round(np.array([heads[row][3] for row in order.tolist()]), 3),
        np.round(np.array([heads[row][4] for row in order.tolist()]), 5),
        np.array([cycle for cycle, _, _ in changes]), start.astype(np.int64),
        np.array([time for _, times, _ in changes for time in times]),
        np.array([state for _, _, states in changes for state in states], np.uint8),
    )  # fmt: skip


def _vehicle_heads(city: City, streets: Streets, network: Network, root: Any) -> list[_Head]:
    assert city.lanes is not None
    ruled = {c.get("via"): (c.get("tl"), int(c.get("linkIndex")))
             for c in root.iter("connection") if c.get("tl") is not None}  # fmt: skip
    found: list[_Head] = []
    for name, number in network.links.items():
        if name not in ruled:
            continue
        link = streets.links[number]
        lanes = [streets.ways[way].lanes[index] for way, index in (link.source, link.target)]
        ids = [int(city.lanes.lane_id[lane.row]) for lane in lanes]
        shape = lanes[0].shape
        step = shape[-1] - shape[-2]
        found.append((ids[0], ids[1], 0, shape[-1], float(np.arctan2(step[1], step[0])),
                      *ruled[name]))  # fmt: skip
    return found


def _walker_heads(city: City, streets: Streets, root: Any, network: Network) -> list[_Head]:
    assert city.network is not None
    found: list[_Head] = []
    for connection in root.iter("connection"):
        edge = connection.get("to")
        if connection.get("tl") is None or edge not in network.crossings:
            continue
        crossing = streets.crossings[network.crossings[edge]]
        own = crossing_ids(city.network.edge_id[crossing.edge], crossing.end)
        step = crossing.shape[1] - crossing.shape[0]
        found.append((0, 0, int(own), crossing.shape.mean(axis=0),
                      float(np.arctan2(step[1], step[0])), connection.get("tl"),
                      int(connection.get("linkIndex"))))  # fmt: skip
    return found


def _shown(
    phases: list[tuple[float, str]], index: int, begin: float
) -> tuple[float, list[float], list[int]]:
    """Return the cycle of a head, and when it changes to what, counted from a moment on."""
    cycle = sum(seconds for seconds, _ in phases)
    ends = np.cumsum([seconds for seconds, _ in phases])
    states = [STATE[LETTERS[state[index]]] for _, state in phases]
    at = begin % cycle
    first = int(np.searchsorted(ends, at, side="right"))
    order = [*range(first, len(phases)), *range(first), first]
    times, shown = [0.0], [states[first]]
    now = float(ends[first] - at)
    for number in order[1:]:
        if now < cycle - 1e-9 and states[number] != shown[-1]:
            times.append(round(now, 3))
            shown.append(states[number])
        now += phases[number][0]
    return cycle, times, shown
