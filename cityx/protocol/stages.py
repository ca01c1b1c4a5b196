"""The stages of a city and the order they must run in."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum

from cityx.errors import UsageError, nearest


class Stage(StrEnum):
    """The paper's six stages, then dynamic agents; edits, conversions and renders fit anywhere."""

    LAYOUT = "layout"
    TERRAIN = "terrain"
    BUILDING = "building"
    ROAD = "road"
    NATURE = "nature"
    BACKGROUND = "background"
    DYNAMIC = "dynamic"
    EDIT = "edit"
    CONVERT = "convert"
    RENDER = "render"


NEUTRAL = frozenset({Stage.EDIT, Stage.CONVERT, Stage.RENDER})

# Each stage and those that must wait for it. Buildings and roads both read the layout and never
# each other, so they run in either order.
ORDER: Mapping[str, tuple[str, ...]] = {
    "layout": ("terrain", "building", "road", "nature"),
    "terrain": ("building", "road", "nature"),
    "road": ("dynamic",),
}


def to_stage(word: str) -> Stage:
    """Return the stage of a name.

    Raises
    ------
    UsageError
        If there is none.
    """
    try:
        return Stage(word)
    except ValueError:
        known = [stage.value for stage in Stage]
        hint = nearest(word, known) or f" Known are {', '.join(known)}."
        raise UsageError(f'There is no stage "{word}".{hint}') from None


def topological_order(
    edges: Mapping[str, Iterable[str]], nodes: Iterable[str] = ()
) -> tuple[str, ...]:
    """Order the nodes of a graph so that every edge points forward, ties by name.

    Parameters
    ----------
    edges
        Node to the nodes that must come after it.
    nodes
        Nodes without edges.

    Raises
    ------
    UsageError
        If the graph has a cycle; the message shows it.
    """
    after = {node: sorted(set(followers)) for node, followers in edges.items()}
    names = sorted({*after, *nodes, *(n for followers in after.values() for n in followers)})
    waiting = dict.fromkeys(names, 0)
    for followers in after.values():
        for name in followers:
            waiting[name] += 1
    ready = [name for name in names if not waiting[name]]
    heapq.heapify(ready)
    order: list[str] = []
    while ready:
        node = heapq.heappop(ready)
        order.append(node)
        for name in after.get(node, ()):
            waiting[name] -= 1
            if not waiting[name]:
                heapq.heappush(ready, name)
    if len(order) < len(names):
        raise UsageError(f"The order has a cycle: {' -> '.join(_cycle(after, set(order)))}.")
    return tuple(order)


def _cycle(after: Mapping[str, Sequence[str]], done: set[str]) -> list[str]:
    before: dict[str, str] = {}
    for node in sorted(after, reverse=True):
        for name in after[node]:
            if node not in done and name not in done:
                before[name] = node
    node = min(before)
    seen: list[str] = []
    while node not in seen:
        seen.append(node)
        node = before[node]
    loop = [*seen[seen.index(node) :], node]
    return loop[::-1]


def stage_of(action_id: str) -> Stage:
    """Return the stage an action id names by its first word."""
    return to_stage(action_id.partition("/")[0])


def stages_before(stage: str, order: Mapping[str, Iterable[str]] = ORDER) -> frozenset[str]:
    """Return every stage that must come before one, directly or by way of others."""
    found: set[str] = set()
    open_stages = [stage]
    while open_stages:
        current = open_stages.pop()
        for earlier, followers in order.items():
            if current in followers and earlier not in found:
                found.add(earlier)
                open_stages.append(earlier)
    return frozenset(found)


def stages_after(stage: str, order: Mapping[str, Iterable[str]] = ORDER) -> frozenset[str]:
    """Return every stage that must wait for one, directly or by way of others."""
    return frozenset(other for other in order_nodes(order) if stage in stages_before(other, order))


def order_nodes(order: Mapping[str, Iterable[str]] = ORDER) -> frozenset[str]:
    """Return the stages that the order speaks of."""
    return frozenset(order) | {name for followers in order.values() for name in followers}


def is_linear_extension(plan: Iterable[str], order: Mapping[str, Iterable[str]] = ORDER) -> bool:
    """Return whether a sequence of stages or action ids never runs a stage too late.

    A stage may run several times and may be left out; neutral stages fit anywhere.
    """
    topological_order(order)
    ran: set[str] = set()
    for item in plan:
        stage = stage_of(item)
        if stage in NEUTRAL:
            continue
        if ran & stages_after(stage, order):
            return False
        ran.add(stage)
    return True
