"""Green wave: signal plans are offset so that green at one signal is followed by green at the next.

Where the ways between signals are short, whole streets stand still if their plans do not fit: what
comes from the one on green fills the few places before the other, which is red.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cityx.geometry.arrays import FloatArray

CYCLE = 60.0  # seconds after which signals begin anew; blocks of old towns hold no longer queues
SHORT = 100.0  # metres of a way over which the weight of a good fit falls
STRAIGHT, TURNING = 3.0, 1.0  # weights of ways across a junction
START_S = 2.0  # seconds until those who stood at a red line are under way
ROUNDS = 8  # of trying every signal; they settle in three or four


@dataclass(frozen=True)
class _Head:
    """A way across a junction under signals: the plan, its place there, and where it leads."""

    plan: str
    link: int
    source: str
    target: str
    weight: float


def coordinate(root: Any) -> None:
    """Write into a network when the plans of its signals begin.

    Parameters
    ----------
    root
        Of the network's XML; all plans take equally long.
    """
    green = {plan.get("id"): _greens(plan) for plan in root.iter("tlLogic")}
    fit = _fits(root, green)
    offset = dict.fromkeys(green, 0)
    for _ in range(ROUNDS):
        before = dict(offset)
        for plan in sorted(offset):
            gain = sum((np.roll(values, offset[other]) for other, values in
                        sorted(fit.get(plan, {}).items())), np.zeros(round(CYCLE)))  # fmt: skip
            best = int(np.argmax(gain))
            if gain[best] > gain[offset[plan]] + 1e-9:
                offset[plan] = best
        if offset == before:
            break
    for plan in root.iter("tlLogic"):
        plan.set("offset", str(offset[plan.get("id")]))


def _greens(plan: Any) -> FloatArray:
    """(l, c) what each link gets of each second of a plan: 1 on green, less where it yields."""
    share = {"G": 1.0, "g": 0.5}
    columns = []
    for phase in plan.findall("phase"):
        states = [share.get(letter, 0.0) for letter in phase.get("state")]
        columns += [states] * round(float(phase.get("duration")))
    return np.array(columns).T


def _fits(root: Any, green: dict[str, FloatArray]) -> dict[str, dict[str, FloatArray]]:
    """Return for pairs of plans what each delay of the first against the second is worth."""
    edges = {edge.get("id"): edge.find("lane") for edge in root.iter("edge")}
    heads = [
        _Head(c.get("tl"), int(c.get("linkIndex")), c.get("from"), c.get("to"),
              STRAIGHT if c.get("dir") == "s" else TURNING)
        for c in root.iter("connection")
        if c.get("tl") is not None and c.get("to") in edges and not c.get("from").startswith(":")
    ]  # fmt: skip
    leaving: dict[str, list[_Head]] = {}
    for head in heads:
        leaving.setdefault(head.source, []).append(head)
    cycle = round(CYCLE)
    fit: dict[str, dict[str, FloatArray]] = {}
    for first in heads:
        lane = edges[first.target]
        length = float(lane.get("length"))
        later = round(START_S + length / max(float(lane.get("speed")), 1.0))
        for second in leaving.get(first.target, []):
            if second.plan == first.plan:
                continue
            a, b = green[first.plan][first.link], green[second.plan][second.link]
            if len(a) != cycle or len(b) != cycle:
                continue
            weight = first.weight * second.weight * np.exp(-length / SHORT)
            # Worth of the second's plan beginning so many seconds after the first's.
            worth = np.array([a @ np.roll(b, shift - later) for shift in range(cycle)]) * weight
            there = fit.setdefault(second.plan, {})
            there[first.plan] = there.get(first.plan, 0.0) + worth
            back = fit.setdefault(first.plan, {})
            mirrored = np.roll(worth[::-1], 1)
            back[second.plan] = back.get(second.plan, 0.0) + mirrored
    return fit
