"""Signal phases that clear vehicles turning across oncoming traffic.

Who turns from a lane that others drive straight on in holds all of them while no gap comes. So
the others get red some seconds before, and the first of those who turn gets out. The others are
also those who come towards them and turn into the same street: they give way to people alone.
"""

from __future__ import annotations

from copy import deepcopy
from itertools import pairwise
from typing import Any

CLEARING = 3.0  # seconds of yellow, and then of green for those who turn
LEAST = 12.0  # seconds of green that are left to the others
SHORTEST = 8.0  # seconds of it where a junction has many stages


def let_turners_out(root: Any) -> None:
    """Write into the plans of a network when those who give way on green go alone."""
    foes, yields = _pairs(root, "foes"), _pairs(root, "response")
    for plan in root.iter("tlLogic"):
        name = plan.get("id")
        for phase, after in _last_greens(plan):
            _divide(plan, phase, after, foes.get(name, {}), yields.get(name, {}))


def _pairs(root: Any, key: str) -> dict[str, dict[int, set[int]]]:
    """Return for each plan which of its links cross each other, or give way to which."""
    requests = {
        junction.get("id"): [request.get(key)[::-1] for request in junction.findall("request")]
        for junction in root.iter("junction")
    }
    found: dict[str, dict[int, set[int]]] = {}
    place: dict[tuple[str, int], int] = {}
    for connection in root.iter("connection"):
        via, plan = connection.get("via"), connection.get("tl")
        if via is not None and plan is not None:
            junction, edge, lane = via[1:].rsplit("_", 2)
            index = int(connection.get("linkIndex"))
            place[junction, int(edge) + int(lane)] = index
            found.setdefault(plan, {})[index] = set()
    for (junction, row), index in place.items():
        for other, bit in enumerate(requests[junction][row]):
            if bit == "1" and (junction, other) in place:
                found[junction][index].add(place[junction, other])
    return found


def _last_greens(plan: Any) -> list[tuple[Any, Any]]:
    """Return the phases that yellow follows, with the yellow ones."""
    phases = plan.findall("phase")
    return [
        (phase, after) for phase, after in pairwise(phases)
        if "g" in phase.get("state") and "y" in after.get("state") and "y" not in phase.get("state")
    ]  # fmt: skip


def _divide(
    plan: Any, phase: Any, after: Any, foes: dict[int, set[int]], yields: dict[int, set[int]]
) -> None:
    state = phase.get("state")
    green = {index for index in foes if state[index] in "gG"}
    turning = {index for index in green if state[index] == "g" and yields[index] & green}
    held = {other for index in turning for other in foes[index] & green} - turning
    if not held:
        return
    before = phase.getprevious()
    spare = float(phase.get("duration")) - 2 * CLEARING
    if 0.0 <= spare < SHORTEST and not _held_before(before, held):
        return
    if spare < 0.0:  # the phase in which people get off the roadway is too short for it
        if before is None or float(before.get("duration")) + spare < LEAST:
            return
        before.set("duration", f"{float(before.get('duration')) + spare:g}")
    slowing, alone = deepcopy(phase), deepcopy(phase)
    slowing.set("state", _with(state, held, "y"))
    free = {index for index in turning if not foes[index] & turning}
    alone.set("state", _with(_with(state, held, "r"), free, "G"))
    after.set("state", _with(after.get("state"), held, "r"))
    for part in (slowing, alone):
        part.set("duration", f"{CLEARING:g}")
        after.addprevious(part)
    if spare > 0.0:
        phase.set("duration", f"{spare:g}")
    else:
        plan.remove(phase)


def _held_before(before: Any, links: set[int]) -> bool:
    """Return whether some links have green in a phase already."""
    return before is not None and all(before.get("state")[link] in "gG" for link in links)


def _with(state: str, links: set[int], letter: str) -> str:
    return "".join(letter if index in links else old for index, old in enumerate(state))
