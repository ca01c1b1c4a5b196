"""The baseline: a driver by rule on worlds, and what came of its episodes."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from cityx.geometry.arrays import FloatArray
from cityx.sim.engine import Engine
from cityx.sim.kernels.tables import GOAL_REACHED, RED_LIGHT
from cityx.sim.state import DT


@dataclass(frozen=True)
class Trips:
    """What came of episodes.

    Attributes
    ----------
    ends
        How many ended by each event, by the names of the engine.
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
    """Return what the baseline does, (E, A, a); the state is only read."""
    return engine.act_by_rule()


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
        action = (rng.uniform(-1, 1, (engine.worlds, engine.agents, engine.action_size)) if chance
                  else rule_actions(engine))  # fmt: skip
        routes, before = goal.copy(), gone.copy()
        engine.step(action)
        steps += 1
        out = engine.out
        live = done < episodes
        over = (out.ended | out.late) & live
        lights += int(((out.event & RED_LIGHT) != 0)[live].sum())
        metres += float((out.completion * routes - before).clip(0)[live].sum())
        for bits in out.event[over].tolist():
            ends[end_of(engine, bits)] += 1
        done += over
    return Trips(dict(ends), metres, lights, steps * DT)


def end_of(engine: Engine, bits: int) -> str:
    """Return the event that an episode ended by."""
    if bits & GOAL_REACHED:
        return "goal"
    names = [name for number, name in enumerate(engine.events) if bits >> number & 1]
    return next(name for name in engine.ways_to_end if name in names)
