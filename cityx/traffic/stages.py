"""Signal plan by stages, where netconvert's leaves an approach too little green.

It gives the approaches of a large junction turns of their own, also those whose ways never meet,
and lets each turn last as long as people need, so that green gets short or comes rarely.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray
from cityx.traffic.coordination import CYCLE

LEAST = 6.0  # seconds of green of a stage
POOR = 10.0  # seconds of green in a cycle; a plan that leaves less to somebody is made anew
YELLOW = 3.0  # seconds
CLEARING = 12.0  # metres of the longest way across a junction for each second of red for all
MOST_CLEARING = 4.0  # seconds
STROLL = 1.2  # metres per second of the slowest who cross
WALKING = 4.0  # seconds for which people see green at least
OPPOSED = -0.7  # cosine between approaches whose turns give way to each other on green
TURNS = frozenset("lrtT")  # directions that give way to people on green


@dataclass(frozen=True)
class _Junction:
    """What crosses a junction: l ways, of vehicles and of people.

    Attributes
    ----------
    foes, yields
        (l, l) bool, ways that meet, and which give way to which.
    turns
        (l,) bool, whether each leads round a corner.
    groups
        Ways that get green together: of one approach, or one crossing.
    heading
        (g, 2) directions of approaches, none of crossings.
    lanes
        (g,) how many lanes approaches have, none crossings.
    length
        (l,) metres.
    """

    foes: NDArray[np.bool_]
    yields: NDArray[np.bool_]
    turns: NDArray[np.bool_]
    groups: list[list[int]]
    heading: FloatArray
    lanes: NDArray[np.int64]
    length: FloatArray

    def together(self, one: int, other: int) -> bool:
        """Return whether two groups may have green at once."""
        if not self.lanes[one] and not self.lanes[other]:
            return True
        pairs = [(i, j) for i in self.groups[one] for j in self.groups[other] if self.foes[i, j]]
        if self.lanes[one] and self.lanes[other]:
            facing = float(self.heading[one] @ self.heading[other]) < OPPOSED
            return not pairs or (
                facing
                and all(
                    self.yields[i, j] != self.yields[j, i] and self.turns[i if self.yields[i, j]
                                                                          else j]
                    for i, j in pairs
                )
            )  # fmt: skip
        return all(
            (self.turns[i] and self.yields[i, j]) if self.lanes[one]
            else (self.turns[j] and self.yields[j, i])
            for i, j in pairs
        )  # fmt: skip


def restage(root: Any) -> None:
    """Write stage plans into a network where its own leave an approach too little green.

    Parameters
    ----------
    root
        Of the network's XML; each plan rules one junction.
    """
    edges = {edge.get("id"): edge for edge in root.iter("edge")}
    requests = {each.get("id"): each.findall("request") for each in root.iter("junction")}
    ruled: dict[str, list[Any]] = {}
    for connection in root.iter("connection"):
        if connection.get("tl") is not None:
            ruled.setdefault(connection.get("tl"), []).append(connection)
    for plan in root.iter("tlLogic"):
        name = plan.get("id")
        phases = [(float(p.get("duration")), p.get("state")) for p in plan.findall("phase")]
        connections = ruled.get(name, [])
        if len(requests.get(name, [])) != len(phases[0][1]) or not connections:
            continue
        driven = [int(c.get("linkIndex")) for c in connections if not c.get("from").startswith(":")]
        least = _least(phases, driven)
        cycle = sum(seconds for seconds, _ in phases)
        if least >= POOR and cycle <= CYCLE:
            continue
        junction = _junction(edges, requests[name], connections)
        made = _phases(junction, _stages(junction))
        if cycle > CYCLE or _least(made, driven) > least:
            for phase in plan.findall("phase"):
                plan.remove(phase)
            for seconds, state in made:
                plan.append(plan.makeelement("phase", duration=f"{seconds:g}", state=state))


def _least(phases: list[tuple[float, str]], links: list[int]) -> float:
    """Return the seconds of green that the worst off of some links gets."""
    return min((sum(seconds for seconds, state in phases if state[link] in "Gg")
                for link in links), default=0.0)  # fmt: skip


def _junction(edges: dict[str, Any], requests: list[Any], connections: list[Any]) -> _Junction:
    count = len(requests)
    foes, yields = (
        np.array([[bit == "1" for bit in request.get(key)[::-1]] for request in requests])
        for key in ("foes", "response")
    )
    turns, length = np.zeros(count, bool), np.zeros(count)
    groups: dict[str, list[int]] = {}
    for connection in connections:
        link = int(connection.get("linkIndex"))
        walked = connection.get("from").startswith(":")
        edge = connection.get("to") if walked else connection.get("from")
        groups.setdefault(edge, []).append(link)
        turns[link] = not walked and connection.get("dir") in TURNS
        across = edge if walked else connection.get("via").rpartition("_")[0]
        length[link] = max(float(lane.get("length")) for lane in edges[across].iter("lane"))
    names = sorted(groups)
    walked = np.array([name.startswith(":") for name in names])
    lanes = [len({c.get("fromLane") for c in connections if c.get("from") == name})
             for name in names]  # fmt: skip
    heading = np.array([_heading(edges[name]) for name in names])
    return _Junction(foes | foes.T, yields, turns, [sorted(groups[name]) for name in names],
                     heading, np.where(walked, 0, lanes), length)  # fmt: skip


def _heading(edge: Any) -> FloatArray:
    """(2,) direction in which an edge ends."""
    shape = [point.split(",")[:2] for point in edge.find("lane").get("shape").split()]
    step = np.array(shape[-1], float) - np.array(shape[-2], float)
    return np.asarray(step / max(float(np.hypot(*step)), 1e-9))


def _stages(junction: _Junction) -> list[list[int]]:
    """Put groups together into as few stages as come about if the widest approaches go first."""
    order = np.argsort(-junction.lanes, kind="stable").tolist()
    stages: list[list[int]] = []
    for group in order:
        fits = [stage for stage in stages if all(junction.together(group, o) for o in stage)]
        if fits:
            fits[0].append(group)
        else:
            stages.append([group])
    for stage in stages:  # who meets nobody there goes with others as well
        for group in order:
            if group not in stage and all(junction.together(group, other) for other in stage):
                stage.append(group)
    return stages


def _phases(junction: _Junction, stages: list[list[int]]) -> list[tuple[float, str]]:
    green = [sorted(link for group in stage for link in junction.groups[group])
             for stage in stages]  # fmt: skip
    letters = [
        {link: "g" if junction.yields[link, own].any() else "G" for link in own} for own in green
    ]
    walked = {link for group in np.flatnonzero(junction.lanes == 0).tolist()
              for link in junction.groups[group]}  # fmt: skip
    clear = float(np.clip(round(float(junction.length.max()) / CLEARING), 1.0, MOST_CLEARING))
    weight = np.array([1.0 + max(junction.lanes[group] for group in stage) for stage in stages])
    count = len(stages)
    spare = max(CYCLE - count * (YELLOW + clear + LEAST), 0.0)
    ends = np.rint(np.cumsum(LEAST + spare * weight / weight.sum()))
    lasts = np.diff(ends, prepend=0.0)
    found: list[tuple[float, str]] = []
    for number, own in enumerate(letters):
        after = letters[(number + 1) % count]
        ending = [link for link in own if link not in after]
        strollers = [link for link in ending if link in walked]
        last = float(lasts[number])
        need = max((ceil(junction.length[link] / STROLL) for link in strollers), default=0)
        early = float(np.clip(need - YELLOW - clear, 0.0, last - WALKING))
        halted = own | dict.fromkeys(strollers, "r")
        slowing = halted | {link: "y" for link in ending if link not in walked}
        stopped = own | dict.fromkeys(ending, "r")
        for seconds, shown in (
            (last - early, own), (early, halted), (YELLOW, slowing), (clear, stopped)
        ):  # fmt: skip
            if seconds > 0.0:
                state = "".join(shown.get(link, "r") for link in range(len(junction.length)))
                found.append((seconds, state))
    return found
