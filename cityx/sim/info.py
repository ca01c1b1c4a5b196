"""What environments tell beside observation and reward: events with ids, terms, progress."""

from __future__ import annotations

from typing import Any

import numpy as np

from cityx.ids import id_text
from cityx.sim.engine import Engine
from cityx.sim.kernels.tables import CRASH_HUMAN, CRASH_OBJECT, CRASH_VEHICLE, GOAL_REACHED
from cityx.sim.kernels.tables import X as ROW_X
from cityx.sim.kernels.tables import Y as ROW_Y

SUCCESS = 1.0


def happened(engine: Engine, world: int, agent: int) -> list[dict[str, Any]]:
    """Return the events of an agent's last step.

    Returns
    -------
    events
        Each with "event" of ``engine.events`` and, of a crash, "object": the id of what was hit,
        as in masks and reports, or ``traffic:N``, ``person:N`` and ``agent:N`` for movers.
    """
    bits = int(engine.out.event[world, agent])
    found: list[dict[str, Any]] = []
    for number, name in enumerate(engine.events_of(agent)):
        if bits >> number & 1:
            one: dict[str, Any] = {"event": name}
            if (1 << number) & (CRASH_VEHICLE | CRASH_OBJECT | CRASH_HUMAN):
                one["object"] = struck(engine, int(engine.out.touched[world, agent]), agent)
            found.append(one)
    return found


def struck(engine: Engine, touched: int, agent: int = 0) -> str:
    """Return the name of what an agent touched."""
    if touched <= -2:
        return mover_name(engine, -2 - touched)
    return id_text(engine.struck(touched, agent))


def mover_name(engine: Engine, mover: int) -> str:
    """Return what a mover is called in events; masks have `stable_id` of "sim" and this."""
    if mover < engine.agents:
        return f"agent:{mover}"
    mover -= engine.agents
    return f"person:{mover}" if mover < engine.people else f"traffic:{mover - engine.people}"


def info_of(engine: Engine, world: int, agent: int) -> dict[str, Any]:
    """Return what a single environment tells of a step."""
    out = engine.out
    bits = int(out.event[world, agent])
    return {
        "cost": float(out.cost[world, agent]),
        "events": happened(engine, world, agent) if bits else [],
        "is_success": bool(bits & GOAL_REACHED),
        "route_completion": float(out.completion[world, agent]),
        "reward_terms": dict(
            zip(engine.terms_of(agent), out.term[:, world, agent].tolist(), strict=True)
        ),
    }


def infos_of(engine: Engine) -> dict[str, Any]:
    """Return what a batch tells of a step, an array per name, and "_name" where it holds."""
    out, shape = engine.out, engine.out.cost.size
    everywhere = np.ones(shape, bool)
    told = {
        "cost": out.cost.ravel().copy(), "events": out.event.ravel().copy(),
        "is_success": (out.event.ravel() & GOAL_REACHED) != 0,
        "route_completion": out.completion.ravel().copy(),
    }  # fmt: skip
    return told | {f"_{name}": everywhere for name in told}


def place_of(engine: Engine, world: int, agent: int) -> tuple[float, float]:
    """Return where an agent is, metres."""
    real = engine.state.real[world]
    return float(real[ROW_X, agent]), float(real[ROW_Y, agent])
