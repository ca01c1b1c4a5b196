"""One step of worlds whose agents are of all kinds: they drive, fly and walk among each other.

Rows of movers are those who drive, who fly, who walk, then people, then traffic. Each agent has
rules of its own, (A, numbers) of `cityx.sim.kernels.tables.NUMBERS`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cityx.geometry.compiled import borrowing, compiled
from cityx.sim.kernels import fly, roam, roam_rule, spawn, step
from cityx.sim.kernels.draws import drawn, mixed
from cityx.sim.kernels.observe import NEIGHBOURS, look
from cityx.sim.kernels.one import world_at
from cityx.sim.kernels.paths import crossing_at
from cityx.sim.kernels.people import begin_person, walk_people
from cityx.sim.kernels.pursuit import driver
from cityx.sim.kernels.roam_look import look_about
from cityx.sim.kernels.tables import (
    ALIVE,
    BEFORE,
    CLEARED,
    CRASH_OBJECT,
    CRASH_VEHICLE,
    DRAWS,
    DT,
    KIND,
    LEAVES,
    PEOPLE,
    PIECE,
    SIZE,
)
from cityx.sim.kernels.traffic import drive_traffic

NEAR = 45.0  # metres from an agent that people begin


@compiled
def begin_worlds(world: Any, paths: Any, batch: Any, rules: Any, cuts: Any, chosen: Any) -> None:
    """Begin the next episode of chosen worlds, (E,) bool.

    Parameters
    ----------
    cuts
        (3,) int64: how many drive, how many drive or fly, and how many agents there are.
    """
    agents = cuts[2]
    feet = agents + int(rules[0, PEOPLE])
    for e in np.flatnonzero(chosen):
        here = world_at(batch, e)
        here.episode[0] += 1
        here.key[0] = mixed(here.seed[0] ^ mixed(np.uint64(here.episode[0])))
        for n in range(here.real.shape[1]):
            here.whole[DRAWS, n] = here.whole[ALIVE, n] = 0
        here.clock[0] = 3600.0 * drawn(here, 0)
        for n in range(cuts[0]):
            spawn.begin_agent(world, here, rules[n], n)
        for n in range(cuts[0], cuts[1]):
            nowhere(here, n)
            fly.begin_agent(paths.top, paths.top_frame, here, rules[n], n)
        for n in range(cuts[1], agents):
            roam.begin_agent(paths, here, rules[n], n, 0)
        for n in range(feet, here.real.shape[1]):
            spawn.begin_traffic(world, here, n, agents, 0.0)
        for n in range(agents, feet):
            here.whole[PIECE, n] = -1
            begin_person(paths, here, n, agents, NEAR, True)


@borrowing
def nowhere(here: Any, n: int) -> None:
    """Note that a mover is on no lane."""
    here.whole[KIND, n] = here.whole[SIZE, n] = 0
    here.whole[PIECE, n] = here.whole[BEFORE, n] = here.whole[CLEARED, n] = -1
    here.whole[LEAVES, n] = -1


@compiled
def step_worlds(
    world: Any, paths: Any, row: Any, batch: Any, rules: Any, cuts: Any, action: Any, out: Any,
    low: int, high: int,
) -> None:  # fmt: skip
    """Step worlds `low` to `high`; nobody begins anew.

    Parameters
    ----------
    row
        Raster of whose the tops of `paths` are.
    cuts
        As of `begin_worlds`.
    action
        (E, A, 4) float64 between -1 and 1; who drives or walks takes the first two.
    """
    near = np.empty(batch.real.shape[2], np.int64)
    agents = cuts[2]
    feet = agents + int(rules[0, PEOPLE])
    for e in range(low, high):
        here = world_at(batch, e)
        here.clock[0] += rules[0, DT]
        drive_traffic(world, here, rules[0], feet, agents, near)
        walk_people(world, paths, here, rules[0], agents, cuts[1], feet, NEAR)
        for n in range(agents):
            if here.whole[ALIVE, n] == 0:
                step.nothing(out, e, n)
            elif n < cuts[0]:
                step.move(world, here, rules[n], action[e, n, 0], action[e, n, 1], n)
            elif n < cuts[1]:
                fly.soar(here, rules[n], action[e, n], n)
        for n in range(cuts[1]):
            if here.whole[ALIVE, n] != 0:
                if n < cuts[0]:
                    step.judge(world, here, rules[n], out, e, n)
                else:
                    fly.judge(paths.top, row, paths.top_frame, here, rules[n], out, e, n)
        for n in range(cuts[1], agents):
            if here.whole[ALIVE, n] != 0:
                before = crossing_at(paths, here.real[0, n], here.real[1, n])
                bits = roam.go(paths, here, rules[n], action[e, n, 0], action[e, n, 1], n)
                touched = roam.touched_any(world, here, n)
                if touched != -1:
                    bits |= CRASH_VEHICLE if touched < 0 else CRASH_OBJECT
                roam.judge(world, paths, here, rules[n], out, e, n, before, bits, touched)


@compiled
def observe(
    world: Any, paths: Any, batch: Any, rules: Any, cuts: Any, preset: int, drives: Any,
    flies: Any, walks: Any,
) -> None:  # fmt: skip
    """Write what agents observe.

    Parameters
    ----------
    preset
        Of who drives, of `cityx.sim.kernels.observe`.
    drives, flies, walks
        (E, k, d) float32, for those who drive, fly and walk.
    """
    nearest, square = np.empty(NEIGHBOURS, np.int64), np.empty(NEIGHBOURS)
    agents = cuts[2]
    feet = agents + int(rules[0, PEOPLE])
    for e in range(drives.shape[0]):
        here = world_at(batch, e)
        for n in range(cuts[0]):
            look(world, here, rules[n], preset, n, drives[e, n], nearest, square)
        for n in range(cuts[0], cuts[1]):
            fly.look(paths.top, paths.top_frame, here, n, flies[e, n - cuts[0]])
        for n in range(cuts[1], agents):
            look_about(world, paths, here, rules[n], n, cuts[1], feet, walks[e, n - cuts[1]],
                       nearest, square)  # fmt: skip


@compiled
def rule(world: Any, paths: Any, batch: Any, rules: Any, cuts: Any, action: Any) -> None:
    """Write what agents by rule do to (E, A, 4) actions; the state is only read."""
    near = np.empty(batch.real.shape[2], np.int64)
    feet = cuts[2] + int(rules[0, PEOPLE])
    for e in range(action.shape[0]):
        here = world_at(batch, e)
        for n in range(cuts[2]):
            if here.whole[ALIVE, n] == 0:
                continue
            if n < cuts[0]:
                action[e, n, 0], action[e, n, 1] = driver(world, here, rules[n], n, near)
            elif n < cuts[1]:
                fly.pilot(paths.top, paths.top_frame, here, n, action[e, n])
            else:
                one, two = roam_rule.follower(world, paths, here, n, cuts[1], cuts[2], feet)
                action[e, n, 0], action[e, n, 1] = one, two
