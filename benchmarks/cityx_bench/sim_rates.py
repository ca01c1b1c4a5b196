"""Rates of the simulator, in steps per second of the processor's time of one thread."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from cityx.sim.contact.window import ContactWindow
from cityx.sim.engine import Engine
from cityx.sim.env import CityEnv
from cityx.sim.kernels import sense
from cityx.sim.options import options_of
from cityx.sim.places import scenery_of
from cityx.sim.sensors import REACH
from cityx_bench.sim_bars import Asked, Finding, at_least, at_most, missing

# Worlds, agents, traffic, what is observed, and the bar in steps of agents per second.
Rate = tuple[int, int, int, str, int]
BATCHES: tuple[Rate, ...] = ((256, 32, 0, "state", 300_000), (1024, 1, 30, "state", 80_000))
LARGE: tuple[Rate, ...] = ((32, 32, 0, "puffer", 100_000), (32, 1, 30, "metadrive", 5_000))
SINGLE = 20_000  # of one environment with 30 vehicles
STEPS = 60
RINGS, AROUND, MOVERS, SWEEPS = 16, 1024, 100, 25
TREE_MS = 0.3
CAMERAS = {(84, 84): 60, (320, 240): 12, (640, 480): 5}  # pixels -> frames
READY_S, CONTACT_MS, STEP_S = 0.2, 0.15, 0.1
_WHEELS = "".join(
    f"""<body pos="{x} {y} -0.05"><joint name="w{n}" type="hinge" axis="0 1 0"/>
    <geom type="cylinder" size="0.12 0.03" euler="90 0 0" mass="1"/></body>"""
    for n, (x, y) in enumerate(((0.2, 0.25), (0.2, -0.25), (-0.2, 0.25), (-0.2, -0.25)))
)
_MOTORS = "".join(f'<velocity joint="w{n}" kv="5"/>' for n in range(4))
ROBOT = f"""<mujoco><worldbody><body name="robot" pos="0 0 0.2"><freejoint/>
    <geom type="box" size="0.3 0.2 0.08" mass="20"/>{_WHEELS}</body></worldbody>
    <actuator>{_MOTORS}</actuator></mujoco>"""
PEER = "highway-fast-v0"


def per_second(step: Callable[[], object], count: int) -> float:
    """Return how often something is done in a second of processor time; once more before."""
    step()
    begun = time.process_time()
    for _ in range(count):
        step()
    return count / max(time.process_time() - begun, 1e-9)


def rates(asked: Asked) -> Iterator[Finding]:
    """Bar 1."""
    steps = STEPS // (4 if asked.quick else 1)
    yield from (_batch(asked, rate, steps) for rate in BATCHES)
    env = CityEnv(asked.places[0].world, traffic=30)
    rate = _stepped(env, np.array([0.0, 0.3], np.float32), 400 if asked.quick else 4000)
    env.close()
    yield at_least("one environment of Gymnasium, 30 vehicles: steps", rate, SINGLE)
    yield _peer(40 if asked.quick else 200)


def large(asked: Asked) -> Iterator[Finding]:
    """Bar 2."""
    return (_batch(asked, rate, STEPS // (4 if asked.quick else 1)) for rate in LARGE)


def _batch(asked: Asked, rate: Rate, steps: int) -> Finding:
    worlds, agents, traffic, observation, bar = rate
    options = {"agents": agents, "traffic": traffic, "observation": observation}
    engine = Engine(asked.places[0].world, options_of(options), worlds)
    engine.seed(0)
    engine.begin()
    rng = np.random.default_rng(0)
    action = rng.uniform(-1, 1, (worlds, agents, 2)) * [0.1, 0.3] + [0.0, 0.3]
    found = worlds * agents * per_second(lambda: engine.step(action), steps)
    return at_least(f"{worlds} x {agents}, {traffic} vehicles, {observation}: steps", found, bar)


def _stepped(env: Any, action: Any, count: int) -> float:
    """Return how many steps an environment takes in a second; episodes begin anew."""
    env.reset(seed=0)

    def once() -> None:
        if any(env.step(action)[2:4]):
            env.reset()

    return per_second(once, count)


def _peer(count: int) -> Finding:
    """Return the rate of highway-env with what it brings, on the same machine in the same run."""
    what = f"beside: highway-env, {PEER}: steps"
    if find_spec("highway_env") is None:
        return Finding(what, "not installed")
    import gymnasium
    import highway_env  # type: ignore[import-not-found]

    if PEER not in gymnasium.registry:
        highway_env._register_highway_envs()
    env = gymnasium.make(PEER)
    rate = _stepped(env, 1, count)
    own: Any = env.unwrapped
    each = own.config["simulation_frequency"] // own.config["policy_frequency"]
    movers = len(own.road.vehicles)
    env.close()
    return Finding(what, f"{rate:,.1f} of {movers} vehicles, {each} substeps")


def cameras(asked: Asked) -> Iterator[Finding]:
    """Bar 6: all four channels, with movers; that they agree with rays is a test."""
    place = asked.places[0]
    for (width, height), bar in CAMERAS.items():
        camera = {"size": (width, height), "fov": 70.0}
        env = CityEnv(place.folder, observation="camera", traffic=30, camera=camera)
        rate = _stepped(env, np.array([0.0, 0.3], np.float32), 20 if asked.quick else 100)
        env.close()
        what = f"{width} x {height}, four channels, level {place.world.facts['lod']}: frames"
        yield at_least(what, rate, bar, ".1f")


def contact(asked: Asked) -> Iterator[Finding]:
    """Bar 8: how soon a window is there, and what a step takes; kerbs and ramps are a test."""
    if find_spec("mujoco") is None:
        yield missing("mujoco is not installed: pip install 'cityx[sim]'")
        return
    place = asked.places[0]
    seen = place.world, scenery_of(place.folder, place.world)
    with TemporaryDirectory() as folder:
        robot = Path(folder) / "robot.xml"
        robot.write_text(ROBOT)
        at = place.world.point[0, :2]
        ready = 1.0 / per_second(lambda: ContactWindow(seen, robot, at=at), 5)
        window = ContactWindow(seen, robot, at=at)
        rate = per_second(lambda: window.step([8.0] * 4), 20 if asked.quick else 100)
    each = 1000.0 / rate / round(STEP_S / window.model.opt.timestep)
    yield at_most("a window of 60 m is ready: s", ready, READY_S, ".2f")
    yield at_most("a step of the contact engine: ms", each, CONTACT_MS, ".3f")


def lidar(asked: Asked) -> Iterator[Finding]:
    """Bar 7: the sweep of many rays, with a hundred movers about."""
    place = asked.places[0]
    engine = Engine(place.world, options_of({"traffic": MOVERS}))
    engine.seed(0)
    engine.begin()
    found = np.zeros((1, 1, RINGS, AROUND), np.float32)
    rings = np.radians(np.linspace(-15.0, 15.0, RINGS))
    world = place.world

    def once() -> None:
        sense.sweep(world.segment, world.cell_start, world.cell_segment, world.cell_frame,
                    engine.state.batch, 1, 1.4, rings, REACH, found)  # fmt: skip

    rate = per_second(once, 5 if asked.quick else 25)
    what = f"{RINGS} x {AROUND} rays, {MOVERS} movers, level {place.world.facts['lod']}: sweeps"
    yield at_least(what, rate, SWEEPS, ".1f")
    # Movers are met as they are: what there is to renew for them is their rows of the state.
    taken = 1000.0 / per_second(engine.state.copy, 200)
    yield at_most("what is renewed for movers before a sweep, ms", taken, TREE_MS, ".3f")
