"""The baseline: a driver by rule on worlds, and what came of its episodes."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from cityx.geometry.arrays import FloatArray
from cityx.sim.engine import DT, Engine
from cityx.sim.kernels import pursuit
from cityx.sim.kernels.tables import EVENTS, GOAL_REACHED

LIGHTS = "red_light"


@dataclass(frozen=True)
class Trips:
    """What came of episodes.

    Attributes
    ----------
    ends
        How many ended by each event of `cityx.sim.kernels.tables.EVENTS`.
    metres
        Driven, along the routes.
    red_lights
        How many were passed.
    seconds
        Of the simulation.
    """

    ends: dict[str, int]
    metres: float
    red_lights: int
    seconds: float

    @property
    def count(self) -> int:
        """Number of episodes."""
        return sum(self.ends.values())

    @property
    def success(self) -> float:
        """Share that reached its goal."""
        return self.ends.get("goal", 0) / max(self.count, 1)


def rule_actions(engine: Engine) -> FloatArray:
    """Return what the driver by rule does, (E, A, 2); the state is only read."""
    action = np.zeros((engine.worlds, engine.agents, 2))
    pursuit.pursue(engine.map, engine.state.batch, engine.rules, action, engine.agents, 0,
                   engine.worlds)  # fmt: skip
    return action


def trips_of(engine: Engine, episodes: int, seed: int = 0, *, chance: bool = False) -> Trips:
    """Drive the first episodes of each agent to their ends.

    Parameters
    ----------
    engine
        Begun anew by this.
    episodes
        Of each agent; all count the same, whether they are short or long.
    seed
        Of the first world, and of actions by chance.
    chance
        Whether actions are drawn by chance instead.
    """
    engine.seed(seed)
    engine.begin()
    rng = np.random.default_rng(seed)
    done = np.zeros((engine.worlds, engine.agents), int)
    ends: Counter[str] = Counter()
    metres, lights, steps = 0.0, 0, 0
    goal, gone = (engine.state.row(name)[:, : engine.agents] for name in ("goal", "gone"))
    while (done < episodes).any():
        action = (rng.uniform(-1, 1, (engine.worlds, engine.agents, 2)) if chance
                  else rule_actions(engine))  # fmt: skip
        routes, before = goal.copy(), gone.copy()
        engine.step(action)
        steps += 1
        out = engine.out
        live = done < episodes
        over = (out.ended | out.late) & live
        lights += int(((out.event & (1 << EVENTS.index(LIGHTS))) != 0)[live].sum())
        metres += float((out.completion * routes - before).clip(0)[live].sum())
        for bits in out.event[over].tolist():
            ends[end_of(bits)] += 1
        done += over
    return Trips(dict(ends), metres, lights, steps * DT)


def end_of(bits: int) -> str:
    """Return the event that an episode ended by."""
    if bits & GOAL_REACHED:
        return "goal"
    names = [name for number, name in enumerate(EVENTS) if bits >> number & 1]
    order = ("crash_vehicle", "crash_object", "off_road", "off_route", "late", "red_light")
    return next(name for name in order if name in names)
