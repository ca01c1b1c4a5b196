"""What the signals of a network show over time, as a value of the city."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.signals import STATE, Signals, crossing_ids
from cityx.ids import hash_ids
from cityx.traffic.network import Network
from cityx.traffic.streets import Streets

FloatArray = NDArray[np.float64]

# Letter of SUMO -> what is shown.
LETTERS = {
    "r": "red", "u": "red_yellow", "y": "yellow", "Y": "yellow", "g": "green_yielding",
    "G": "green", "s": "green_yielding", "o": "off", "O": "off",
}  # fmt: skip
_Head = tuple[int, int, int, FloatArray, float, str, int]  # lane, onto, crossing, at, heading, ...


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
