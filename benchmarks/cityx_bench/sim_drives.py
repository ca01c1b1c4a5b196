"""What drives in the simulator: routes that fit, who arrives, traffic, learning, maps."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.sim.baseline import trips_of
from cityx.sim.dynamics import VEHICLE
from cityx.sim.engine import Engine
from cityx.sim.kernels.boxes import boxes_touch
from cityx.sim.kernels.idm import shown
from cityx.sim.kernels.tables import (
    ALIVE,
    AT,
    BEFORE,
    HEADING,
    LENGTH,
    PIECE,
    SIZE,
    SPEED,
    WIDTH,
    X,
    Y,
    Z,
)
from cityx.sim.options import WalkOptions, options_of
from cityx.sim.roamers import Roamers
from cityx.sim.world import certificate
from cityx_bench.sim_bars import Asked, Finding, Place, at_least, at_most, missing
from cityx_bench.sim_maps import FAILED, LONG, RAN, REFUSED, sweep

ROUTES, CERTIFIED, REAL = 10_000, 0.97, 10
EPISODES = 256
ALONE, IN_TRAFFIC = 0.95, 0.85  # shares that arrive
MINUTES, HOURS, KEPT = 10, 10, 0.6  # of traffic; vehicle hours; share of the speed
YELLOW = 3  # states of signals from which on one may be on the way
ALOFT = 1000.0  # metres above all, where an agent is in nobody's way
SEEDS, LEARNT = 3, 0.8
STEPS = 1000


def routes(asked: Asked) -> Iterator[Finding]:
    """Bar 3."""
    wrong, lanes, fit = 0, 0.0, 0.0
    for place in asked.places:
        found = certificate(place.world)
        own = found.by_vehicle["car"]
        lanes, fit = lanes + found.metres, fit + own
        told = ", ".join(f"{name} {metres / max(found.metres, 1e-9):.1%}"
                         for name, metres in found.by_vehicle.items())  # fmt: skip
        yield Finding(f"{place.name}, {found.metres / 1000:.1f} km", told)
        wrong += _infeasible(place)
    count = len(asked.places)
    yield at_most(f"of {ROUTES:,} routes in each of {count}, with a piece that no car fits along",
                  wrong, 0)  # fmt: skip
    share = fit / max(lanes, 1e-9)
    yield Finding(f"metres of lanes that fit a car, {count} places", f"{share:.1%}",
                  f"{CERTIFIED:.0%} in {REAL}",
                  share >= CERTIFIED if count >= REAL or share < CERTIFIED else None)  # fmt: skip


def _infeasible(place: Place) -> int:
    engine = Engine(place.world, options_of({"traffic": 0}), ROUTES)
    engine.seed(0)
    engine.begin()
    fits = place.world.fits(VEHICLE["car"])
    whole, path = engine.state.whole, engine.state.path
    return sum(not fits[path[e, 0, whole[e, AT, 0] : whole[e, SIZE, 0]]].all()
               for e in range(ROUTES))  # fmt: skip


def arrivals(asked: Asked) -> Iterator[Finding]:
    """Bar 4: Drive and Deliver by rule, alone and among others, and by chance."""
    count = EPISODES // (8 if asked.quick else 1)
    shares: dict[str, list[float]] = {}
    for place in asked.places:
        for task, alone in (("Drive", {"traffic": 0}), ("Deliver", {"traffic": 0, "people": 0})):
            none: dict[str, int] = {}
            for how, options in (("alone", alone), ("in traffic", none)):
                share, ends = _share(place, task, options, count)
                if share is not None:
                    shares.setdefault(f"{task} {how}", []).append(share)
                    ends = f"{share:.1%}  " + ends
                yield Finding(f"{place.name}, {task} {how}", ends)
        chance, _ = _share(place, "Drive", {"traffic": 0}, 200, chance=True)
        shares.setdefault("Drive by chance", []).append(chance or 0.0)
    for what, found in shares.items():
        bar = 0.0 if "chance" in what else ALONE if "alone" in what else IN_TRAFFIC
        make = at_most if bar == 0.0 else at_least
        yield make(f"{what}: mean of {len(found)} places", float(np.mean(found)), bar, ".1%")


def _share(
    place: Place, task: str, options: dict[str, int], count: int, *, chance: bool = False
) -> tuple[float | None, str]:
    """Return the share of episodes that arrive, and what the others end by."""
    worlds = max(count // 4, 1)
    if task == "Drive":
        engine = Engine(place.world, options_of(options), worlds)
    elif place.walks is None:
        return None, "nobody can walk there"
    else:
        kind = int(np.searchsorted(place.walks.route_kind, 1))
        if kind == len(place.walks.route_kind) or place.walks.route_kind[kind] != 1:
            return None, "no way that a robot fits along"
        engine = Roamers(place.world, place.walks, WalkOptions(**options), worlds)  # type: ignore[arg-type]
    found = trips_of(engine, -(-count // worlds), chance=chance)
    others = {name: number for name, number in found.ends.items() if name != "goal"}
    return found.success, ", ".join(f"{name} {number}" for name, number in others.items())


def traffic(asked: Asked) -> Iterator[Finding]:
    """Bar 5: traffic of six vehicles a kilometre for ten minutes, the agent out of its way."""
    minutes = MINUTES // (5 if asked.quick else 1)
    total, pairs, reds, hours = [], 0, 0, 0.0
    for place in asked.places:
        ratio, own_pairs, own_reds, own_hours = _kept_moving(place, minutes)
        total.append(ratio)
        pairs, reds, hours = pairs + own_pairs, reds + own_reds, hours + own_hours
        yield Finding(place.name, f"{ratio:.0%} of speed, {own_pairs} pairs overlap, {own_reds} "
                      f"over red, {own_hours:.1f} vehicle h")  # fmt: skip
    yield at_least(f"least share of speed kept over {minutes} minutes", min(total), KEPT, ".0%")
    enough = None if hours < HOURS else pairs == 0
    yield Finding(f"pairs that overlapped in {hours:.1f} vehicle hours", f"{pairs}",
                  f"0 in {HOURS}", enough if pairs == 0 else False)  # fmt: skip
    yield at_most("vehicles that went over a red light", reds, 0)


def _kept_moving(place: Place, minutes: int) -> tuple[float, int, int, float]:
    """Return the share of speed that is kept, pairs that overlapped, reds passed, vehicle hours."""
    engine = Engine(place.world, options_of({}), 1)
    if engine.traffic == 0:
        return 1.0, 0, 0, 0.0
    engine.seed(0)
    engine.begin()
    world, real, whole = place.world, engine.state.real[0], engine.state.whole[0]
    speeds, pairs, reds, there = [], set(), 0, 0
    for step in range(minutes * 600):
        before = whole[PIECE].copy()
        real[Z, 0] = ALOFT
        engine.step(np.array([[[0.0, -1.0]]]), anew=False)
        rows = np.flatnonzero(whole[ALIVE] == 1)
        rows = rows[rows > 0]
        there += len(rows)
        speeds.append(real[SPEED, rows].mean() if len(rows) else 0.0)
        for m in rows[whole[PIECE, rows] != before[rows]].tolist():
            signal = world.piece_signal[whole[PIECE, m]]
            came = whole[BEFORE, m] == before[m]
            reds += int(signal >= 0 and came
                        and shown(engine.map, signal, engine.state.clock[0]) < YELLOW)  # fmt: skip
        if step % 5 == 0:
            pairs |= _overlaps(real, rows)
    kept = float(np.mean(speeds[-600:]) / max(np.mean(speeds[:600]), 1e-9))
    return kept, len(pairs), reds, there / 36_000


def _overlaps(real: FloatArray, rows: IntArray) -> set[tuple[int, int]]:
    """Return pairs of movers whose bodies overlap at one height."""
    boxes = real[[X, Y, HEADING, LENGTH, WIDTH]][:, rows].T * [1, 1, 1, 0.5, 0.5]
    away = np.hypot(*(boxes[:, None, :2] - boxes[:, :2]).transpose(2, 0, 1))
    near = np.argwhere((away < 8.0) & (np.tri(len(boxes), k=-1) > 0)).tolist()
    return {(int(rows[a]), int(rows[b])) for a, b in near
            if abs(real[Z, rows[a]] - real[Z, rows[b]]) < 2.0
            and boxes_touch(*boxes[a], *boxes[b])}  # fmt: skip


def learning(asked: Asked) -> Iterator[Finding]:
    """Bar 12: a policy learns in made towns, and is judged there and in the first place."""
    if find_spec("torch") is None:
        yield missing("torch is not installed")
        return
    if not asked.learn:
        yield missing("no --learn SECONDS")
        return
    script = Path(__file__).parents[2] / "training/drive.py"
    shares: list[float] = []
    for seed in range(SEEDS):
        done = subprocess.run(
            [sys.executable, str(script), "--towns", "5", "--seconds", str(asked.learn), "--seed",
             str(seed), "--threads", "1", "--held-out", str(asked.places[0].folder)],
            capture_output=True, text=True, check=True,
        )  # fmt: skip
        rows = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
        towns = [row["success"] for row in rows if str(row.get("place", "")).startswith("town")]
        shares.append(float(np.mean(towns)))
        unseen = rows[-1]["success"]
        yield Finding(f"seed {seed}: goals in its towns, and in {asked.places[0].name}",
                      f"{shares[-1]:.0%}, {unseen:.0%}")  # fmt: skip
    yield at_least(
        f"least of {SEEDS} seeds after {asked.learn:g} CPU s", min(shares), LEARNT, ".0%"
    )


def every_map(asked: Asked) -> Iterator[Finding]:
    """Bar 13."""
    if not asked.maps:
        yield missing("no --maps")
        return
    lines: list[str] = []
    found = sweep(asked.maps, 200 if asked.quick else STEPS, asked.limit, lines.append)
    for state in (RAN, REFUSED, LONG):
        yield Finding(f"tasks on {len(asked.maps)} maps that {state}",
                      str(sum(each.state == state for each in found)))  # fmt: skip
    for each in found:
        if each.state != RAN:
            yield Finding(f"{each.place}, {each.task}", f"{each.state}: {each.told}")
    yield at_most("that failed otherwise", sum(each.state == FAILED for each in found), 0)
