"""What an environment has to keep to: the same bytes, checkers, spaces, a quick start, replays."""

from __future__ import annotations

import json
import subprocess
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import redirect_stdout
from hashlib import blake2b
from importlib import import_module
from importlib.util import find_spec
from io import StringIO
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

import cityx
from cityx.errors import CityxError
from cityx.sim.drives import driven
from cityx.sim.engine import Engine
from cityx.sim.options import options_of
from cityx.sim.record import read_recording, replay
from cityx.sim.registration import IDS
from cityx.sim.tasks import CONTACT
from cityx_bench.sim_bars import Asked, Finding, Place, at_most, missing

BATCHES = ((1, 1), (7, 1), (7, 2), (64, 1), (64, 2))  # worlds and threads
STEPS = 120
SEEN = 100_000  # observations that are held to their space
NUMBERS = 10_000_000  # steps of agents by chance
IMPORT, FIRST, ANEW = 1.0, 1.5, 2.0  # CPU s, CPU s and ms
BATCHED = tuple(name for name in IDS if name != CONTACT)  # that kernels step together
CHECKED = ("gymnasium", "pettingzoo", "stable_baselines3")


def digests(place: Any) -> dict[str, str]:
    """Return a digest of world 0 of each batch by its size and threads, over all steps."""
    found = {}
    for worlds, threads in BATCHES:
        engine = Engine(place, options_of({"traffic": 20}), worlds, threads)
        engine.seed(5)
        engine.begin()
        hasher = blake2b(digest_size=16)
        drawn = np.random.default_rng(1).uniform(-0.3, 0.9, (STEPS, 64, 1, 2))
        for action in drawn:
            engine.step(np.ascontiguousarray(action[:worlds]))
            hasher.update(engine.state.digests()[0].encode() + engine.view[0].tobytes())
        engine.close()
        found[f"{worlds} worlds, {threads} threads"] = hasher.hexdigest()
    return found


def same_bytes(asked: Asked) -> Iterator[Finding]:
    """Bar 9: state and observations of one world in batches, threads and processes."""
    place = asked.places[0]
    here = digests(place.world)
    there = json.loads(_python(
        "import json, sys\nfrom cityx.sim.places import world_of\n"
        "from cityx_bench.sim_rules import digests\n"
        "print(json.dumps(digests(world_of(sys.argv[1]))))",
        str(place.folder),
    ))  # fmt: skip
    different = len({*here.values(), *there.values()}) - 1
    sizes = ", ".join(here)
    yield Finding(f"digest of {STEPS} steps, to compare with another machine's",
                  next(iter(here.values())))  # fmt: skip
    yield at_most(f"that differ: {sizes}; another process", different, 0)


def _python(program: str, *words: str) -> str:
    """Return what a program prints in a process of its own."""
    done = subprocess.run([sys.executable, "-c", program, *words], capture_output=True, text=True,
                          check=True)  # fmt: skip
    return done.stdout.strip().splitlines()[-1]


def _placed(place: Place, name: str) -> Path | None:
    """Return what `make` takes for a task, or None where the place has no walks for it."""
    # The folder has the meshes too, which checkers that ask for pictures see, and contacts meet.
    return None if place.walks is None and name != IDS[0] else place.folder


def checkers(asked: Asked) -> Iterator[Finding]:
    """Bar 10."""
    place = asked.places[0]
    for package in CHECKED:
        if find_spec(package) is None:
            yield missing(f"{package} is not installed")
            continue
        said = []
        # A world with contacts has one robot.
        for name in IDS if package != "pettingzoo" else BATCHED:
            given = _placed(place, name)
            if given is not None:
                said += [f"{name}: {told}" for told in _complaints(package, name, given)]
        yield at_most(f"faults and warnings of the checker of {package}", len(said), 0)
        yield from (Finding("", each) for each in said)
    yield from _in_their_spaces(place, SEEN // (10 if asked.quick else 1))
    yield _numbers(place, NUMBERS // (10 if asked.quick else 1))


def _complaints(package: str, name: str, given: Any) -> list[str]:
    """Return what a checker says of an environment."""
    run: Callable[[], None]
    if package == "pettingzoo":
        from pettingzoo.test import parallel_api_test, parallel_seed_test

        task = name.split("/")[1].split("-")[0].lower()

        def fleet() -> Any:
            return cityx.sim.parallel_env("fleet", given, agents=3, task=task)

        def run() -> None:
            parallel_api_test(fleet(), num_cycles=60)
            parallel_seed_test(fleet, num_cycles=30)
    else:
        module = "gymnasium.utils" if package == "gymnasium" else f"{package}.common"
        check_env = import_module(f"{module}.env_checker").check_env

        def run() -> None:
            made = gymnasium.make(name, place=given, render_mode="rgb_array")
            check_env(made.unwrapped)

    with warnings.catch_warnings(record=True) as caught, redirect_stdout(StringIO()):
        warnings.simplefilter("always")
        try:
            run()
        except Exception as error:  # noqa: BLE001  (a checker raises what it likes)
            return [f"{type(error).__name__}: {error}"]
    own = [str(each.message).strip() for each in caught
           if not issubclass(each.category, (DeprecationWarning, ResourceWarning))]  # fmt: skip
    return list(dict.fromkeys(own))


def _in_their_spaces(place: Place, count: int) -> Iterator[Finding]:
    """Hold observations by chance to their space, of every task."""
    seen = out = 0
    names = [name for name in BATCHED if _placed(place, name) is not None]
    for name in names:
        batch = cityx.make_vec(name, _placed(place, name), num_envs=100)
        batch.reset(seed=0)
        batch.action_space.seed(0)
        space = batch.single_observation_space
        for _ in range(-(-count // (100 * len(names)))):
            view = batch.step(batch.action_space.sample())[0]
            out += int((~((view >= space.low) & (view <= space.high)).all(axis=1)).sum())
            seen += len(view)
        batch.close()
    yield at_most(f"of {seen:,} observations by chance, out of their space", out, 0)


def _numbers(place: Place, count: int) -> Finding:
    """Step by chance and count numbers that are none."""
    engine = Engine(place.world, options_of({"agents": 32, "traffic": 0}), 256)
    engine.seed(0)
    engine.begin()
    rng, none = np.random.default_rng(0), 0
    steps = -(-count // (256 * 32))
    for _ in range(steps):
        engine.step(rng.uniform(-1, 1, (256, 32, 2)))
        none += int((~np.isfinite(engine.view)).any(axis=2).sum())
        none += int((~np.isfinite(engine.out.reward)).sum())
    return at_most(
        f"of {steps * 8192 / 1e6:.1f} million steps, with a number that is none", none, 0
    )


def beginnings(asked: Asked) -> Iterator[Finding]:
    """Bar 11: on a compiled world, with kernels that an earlier process compiled."""
    clock = "import time\nbegun = time.process_time()\nimport cityx.sim\n"
    taken = float(_python(clock + "print(time.process_time() - begun)"))
    yield at_most("import of cityx.sim, CPU s", taken, IMPORT, ".2f")
    heavy = _python("import sys, cityx.sim\nprint('bpy' in sys.modules)")
    yield at_most("of them with bpy", int(heavy == "True"), 0)
    program = clock + (
        "import sys\nenv = cityx.sim.make('CityX/Drive-v0', sys.argv[1])\nenv.reset(seed=0)\n"
        "first = time.process_time() - begun\nbegun = time.process_time()\n"
        "for _ in range(100): env.reset()\n"
        "print(first, (time.process_time() - begun) * 10)"
    )
    folder = str(asked.places[0].folder)
    _python(program, folder)
    first, anew = map(float, _python(program, folder).split())
    yield at_most("import, make and first reset, CPU s", first, FIRST, ".2f")
    yield at_most("a later reset, ms", anew, ANEW, ".2f")


def replays(asked: Asked) -> Iterator[Finding]:
    """Bar 14: an episode of each place, kept in the folder of results for versions to come."""
    asked.out.mkdir(parents=True, exist_ok=True)
    for place in asked.places:
        path = asked.out / f"{place.name}.npz"
        kept = path.is_file()
        if not kept:
            driven(place.world, {}, 3, 1, say=lambda _: None, record=path)
        begun = time.process_time()
        try:
            steps = replay(read_recording(path), place.world)
            told, same = f"{steps} steps the same, {time.process_time() - begun:.1f} s", True
        except CityxError as error:
            # Another version says why not; the same one has no excuse.
            told, same = str(error), kept and "differs" not in str(error)
        what = "that an earlier run kept" if kept else "of this run"
        yield Finding(f"{place.name}, recording {what}", told, "the same, or why not", same)
