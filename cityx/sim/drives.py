"""Drives: episodes of the driver by rule, one after the other, told line by line."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.sim.baseline import Trips, end_of, rule_actions
from cityx.sim.cameras import Cameras, Mount
from cityx.sim.info import happened, place_of
from cityx.sim.kernels.tables import RED_LIGHT
from cityx.sim.pictures import picture
from cityx.sim.record import Recorder
from cityx.sim.scenery import Scenery
from cityx.sim.state import DT
from cityx.sim.tasks import DRIVE, engine_of, task_of
from cityx.sim.walks import Walks, walk_certificate
from cityx.sim.world import World, certificate

Say = Callable[[str], None]
Driver = Callable[[Any], NDArray[np.float64]]
FRAMES, EACH = 200, 3  # pictures of a film at most, and steps between them
ABREAST = 4  # pictures in a row of a strip, which has two
FILMED = Mount((320, 200), fov=80.0)  # by the camera of an agent
ABOVE_COLOURS, SEEN_COLOURS = 32, 192  # of a film from above, and by a camera


def certificate_lines(world: World) -> list[str]:
    """Return what can be driven by whom, in lines."""
    found = certificate(world)
    shares = ", ".join(f"{name} {metres / max(found.metres, 1e-9):.1%}"
                       for name, metres in found.by_vehicle.items())  # fmt: skip
    return [f"{world.facts['name']}: {found.metres:.0f} m of lanes, of which fit {shares}"]


def walk_lines(walks: Walks) -> list[str]:
    """Return where who gets on foot or small wheels, in lines."""
    found = walk_certificate(walks)
    room = ", ".join(f"{name} {metres:,.0f}" for name, metres in found.room.items())
    ways = ", ".join(f"{name} {count}" for name, count in found.crossings_by_traveller.items())
    return [
        f"{walks.facts['name']}: {found.area:,.0f} m2 of walks, of which fit {room}",
        f"{found.crossings} crosswalks, of which get across {ways}",
    ]


def driven(
    place: Any, options: Mapping[str, Any], episodes: int, seed: int, *, say: Say,
    task: str = DRIVE, record: Path | None = None, film: Path | None = None,
    scenery: Scenery | None = None, who: Driver = rule_actions,
) -> Trips:  # fmt: skip
    """Run episodes one after the other.

    Parameters
    ----------
    place, options, task
        Where, the fields of the task's options, and which task.
    episodes, seed
        How many, and the seed of the first.
    say
        Called with a line for each event and each end.
    record, film
        Files that take the recording, and a film (.gif) or a strip of pictures (.png).
    scenery
        Of the place, where the film is to show what the agent's camera sees.
    who
        Who says what the agent does, (1, 1, action size) for an engine.
    """
    engine = engine_of(task, 1, 1, {"place": place, **options})
    engine.seed(seed)
    engine.begin()
    recorder = Recorder(engine, seed, task_of(task).name)
    cameras = None if scenery is None else Cameras(engine, scenery, FILMED)
    ends: Counter[str] = Counter()
    frames: list[NDArray[np.uint8]] = []
    metres, lights, steps, number = 0.0, 0, 0, 0
    while number < episodes:
        if film is not None and steps % EACH == 0 and len(frames) < FRAMES:
            frames.append(picture(engine, 0, 0) if cameras is None
                          else cameras.read(("rgb",))["rgb"][0, 0])  # fmt: skip
        action = who(engine)
        route = float(engine.state.row("goal")[0, 0])
        x, y = place_of(engine, 0, 0)
        engine.step(action)
        recorder.took(action)
        steps += 1
        bits = int(engine.out.event[0, 0])
        lights += int(bool(bits & RED_LIGHT))
        if not bits:
            continue
        told = ", ".join(" ".join(map(str, each.values())) for each in happened(engine, 0, 0))
        over = bool(engine.out.ended[0, 0] or engine.out.late[0, 0])
        done = float(engine.out.completion[0, 0])
        say(f"episode {number + 1}, {steps * DT:.1f} s: {told} at ({x:.1f}, {y:.1f})"
            + (f", {done:.0%} of {route:.0f} m" if over else ""))  # fmt: skip
        if over:
            ends[end_of(engine, bits)] += 1
            metres += done * route
            number += 1
    if record is not None:
        recorder.write(record)
    if film is not None:
        _write_film(frames, film, ABOVE_COLOURS if cameras is None else SEEN_COLOURS)
    return Trips(dict(ends), metres, lights, steps * DT)


def fleet_driven(
    place: Any, options: Mapping[str, Any], seed: int, *, say: Say, film: Path | None = None
) -> Counter[tuple[str, str]]:
    """Run an episode of a fleet of mixed bodies by rule.

    Parameters
    ----------
    place, options
        Where, and the fields of `cityx.sim.options.FleetOptions`.
    seed
        Of the episode.
    say
        Called with a line for each agent that leaves.
    film
        File that takes a film or a strip of pictures of the first agent that is under way.

    Returns
    -------
    ends
        How many left, by body and by how.
    """
    from cityx.sim.parallel import FleetEnv

    env = FleetEnv(place, **options)
    env.reset(seed=seed)
    ends: Counter[tuple[str, str]] = Counter()
    frames: list[NDArray[np.uint8]] = []
    steps = 0
    while env.agents:
        if film is not None and steps % EACH == 0 and len(frames) < FRAMES:
            frames.append(picture(env.engine, 0, env.row_of(env.agents[0])))
        _, _, ended, late, infos = env.step(env.act_by_rule())
        steps += 1
        for name in (name for name in infos if ended[name] or late[name]):
            info = infos[name]
            told = ", ".join(" ".join(map(str, each.values())) for each in info["events"])
            say(f"{name}, {steps * DT:.1f} s: {told}, {info['route_completion']:.0%} of its route")
            ends[name.rsplit("_", 1)[0], info["events"][-1]["event"]] += 1
    if film is not None:
        _write_film(frames, film, ABOVE_COLOURS)
    return ends


def _write_film(frames: list[NDArray[np.uint8]], path: Path, colours: int) -> None:
    """Write a film (.gif), or a strip of some of its pictures (.png)."""
    from PIL import Image

    if path.suffix == ".png":
        rows = np.linspace(0, len(frames) - 1, 2 * ABREAST).round().astype(int)
        shown = [np.concatenate([frames[k] for k in half], axis=1) for half in np.split(rows, 2)]
        Image.fromarray(np.concatenate(shown)).quantize(colours).save(path, optimize=True)
        return
    images = [Image.fromarray(frame).quantize(colours) for frame in frames]
    images[0].save(path, save_all=True, append_images=images[1:], duration=round(1000 * EACH * DT),
                   loop=0)  # fmt: skip
