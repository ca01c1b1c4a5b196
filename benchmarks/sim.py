"""Measure the simulator: how fast it steps, what of cities can be driven, who arrives.

    python benchmarks/sim.py [--quick] FOLDER [FOLDER ...]

A block for each built city (`cityx build MAP -o FOLDER --lod 1`). Rates are per second of the
processor's time of one thread, with what is observed; kernels are compiled before. The bars are
those that `docs/simulator.md` names.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np

from cityx.city.store import read_city
from cityx.sim.baseline import trips_of
from cityx.sim.compile.worlds import compile_world
from cityx.sim.engine import Engine
from cityx.sim.env import CityEnv
from cityx.sim.kernels.boxes import boxes_touch
from cityx.sim.kernels.tables import AT, HEADING, LENGTH, SIZE, SPEED, WIDTH, X, Y
from cityx.sim.options import options_of
from cityx.sim.world import World, certificate

# Worlds, agents, traffic, what is observed, and the bar in steps of agents per second.
RATES = (
    (256, 32, 0, "state", 300_000), (1024, 1, 30, "state", 80_000), (32, 1, 30, "state", None),
    (32, 32, 0, "puffer", 100_000), (32, 1, 30, "metadrive", 5_000),
)  # fmt: skip
SINGLE = 20_000  # steps per second of one environment with 30 vehicles
ROUTES = 10_000
EPISODES = 256


def line(what: str, value: str, bar: str = "") -> None:
    """Print one measure."""
    print(f"  {what:<58} {value:>16}  {bar}")


def compiled(folder: Path) -> World:
    """Compile the world of a city twice, the second time with warm kernels."""
    city = read_city(folder / "city")
    world = compile_world(city, "0")
    begin = time.process_time()
    compile_world(city, "0")
    west, south, east, north = city.layout.extent
    area = (east - west) * (north - south) / 1e6
    spent = time.process_time() - begin
    line("compiling, CPU s per km2", f"{spent / area:.1f}", "5")
    return world


def driveable(world: World) -> None:
    """Print what of a world can be driven, and whether routes keep to it."""
    found = certificate(world)
    for name, metres in found.by_vehicle.items():
        bar = "97 %" if name == "car" else ""
        line(f"lanes, metres that fit a {name}", f"{metres / found.metres:.1%}", bar)
    engine = Engine(world, options_of({"traffic": 0, "agents": 1}), ROUTES)
    engine.seed(0)
    engine.begin()
    wrong = 0
    for e in range(ROUTES):
        at, size = engine.state.whole[e, AT, 0], engine.state.whole[e, SIZE, 0]
        wrong += not world.fits(1)[engine.state.path[e, 0, at:size]].all()
    line(f"of {ROUTES} routes, with a piece that no car fits along", f"{wrong}", "0")


def rates(world: World, steps: int) -> None:
    """Print how fast batches step."""
    rng = np.random.default_rng(0)
    for worlds, agents, traffic, observation, bar in RATES:
        options = {"agents": agents, "traffic": traffic, "observation": observation}
        engine = Engine(world, options_of(options), worlds)
        engine.seed(0)
        engine.begin()
        action = rng.uniform(-1, 1, (worlds, agents, 2)) * [0.1, 0.3] + [0.0, 0.3]
        engine.step(action)
        begin = time.process_time()
        for _ in range(steps):
            engine.step(action)
        rate = worlds * agents * steps / (time.process_time() - begin)
        what = f"steps of {worlds} x {agents} agents with {traffic} vehicles, {observation}"
        line(what, f"{rate:,.0f}", f"{bar:,}" if bar else "")
    env = CityEnv(world, traffic=30)
    env.reset(seed=0)
    begin, count = time.process_time(), 4000
    action = np.array([0.0, 0.3], np.float32)
    for _ in range(count):
        _, _, ended, late, _ = env.step(action)
        if ended or late:
            env.reset()
    rate = count / (time.process_time() - begin)
    line("steps of one environment of Gymnasium, 30 vehicles", f"{rate:,.0f}", f"{SINGLE:,}")


def arrivals(world: World) -> None:
    """Print how many routes the driver by rule reaches the ends of, and chance."""
    for what, options, chance, bar in (
        ("without traffic", {"traffic": 0}, False, "95 %"), ("in traffic", {}, False, "85 %"),
        ("by chance", {"traffic": 0}, True, "0 %"),
    ):  # fmt: skip
        found = trips_of(Engine(world, options_of(options), EPISODES // 4), 4, chance=chance)
        line(f"routes of 120 m reached, {what}", f"{found.success:.1%}", bar)


def traffic(world: World, minutes: float) -> None:
    """Print whether the traffic keeps moving, and how often two of its vehicles overlap."""
    engine = Engine(world, options_of({}), 2)
    engine.seed(0)
    engine.begin()
    real, speeds, pairs = engine.state.real, [], set()
    for step in range(int(minutes * 600)):
        real[:, 2, 0] = 1000.0  # the agents are out of the way
        engine.step(np.tile([0.0, -1.0], (2, 1, 1)), anew=False)
        speeds.append(real[:, SPEED, 1:].mean())
        if step % 5:
            continue
        for e in range(2):
            boxes = real[e][[X, Y, HEADING, LENGTH, WIDTH]].T * [1, 1, 1, 0.5, 0.5]
            away = np.hypot(*(boxes[:, None, :2] - boxes[:, :2]).transpose(2, 0, 1))
            for a, b in np.argwhere((away < 8) & (np.tri(len(boxes), k=-1) > 0)):
                level = abs(real[e, 2, a] - real[e, 2, b]) < 2
                if a and b and level and boxes_touch(*boxes[a], *boxes[b]):
                    pairs.add((e, int(a), int(b)))
    last, first = np.mean(speeds[-600:]), np.mean(speeds[:600])
    line(
        f"mean speed after {minutes:g} minutes, of that in the first", f"{last / first:.0%}", "60 %"
    )
    hours = 2 * engine.traffic * minutes / 60
    line(f"pairs of vehicles that overlapped in {hours:.1f} vehicle hours", f"{len(pairs)}", "0")


def main() -> None:
    """Measure each city that is named."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER")
    parser.add_argument("--quick", action="store_true", help="fewer steps and minutes")
    given = parser.parse_args()
    for folder in given.folders:
        print(folder.name)
        world = compiled(folder)
        driveable(world)
        arrivals(world)
        traffic(world, 2.0 if given.quick else 10.0)
        rates(world, 20 if given.quick else 60)


if __name__ == "__main__":
    main()
