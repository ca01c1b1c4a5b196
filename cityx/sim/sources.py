"""Sources of traffic from outside: the tracks of a city, and SUMO in a process for each world."""

from __future__ import annotations

import json
import subprocess
import sys
from collections import deque
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from cityx.city.tracks import Tracks
from cityx.errors import EngineError, InputError, MissingExtra, UsageError
from cityx.geometry.arrays import FloatArray
from cityx.sim.options import SUMO, DriveOptions
from cityx.sim.others import MOST, Bodies, Recorded, Source
from cityx.sim.places import store_of
from cityx.sim.state import DT
from cityx.sim.world import World
from cityx.system.packed import read_arrays

DRIVER = "cityx.motion.live_traffic"  # run as a process of its own
_ENDED = "The process of SUMO has ended."
_TOLD = 3  # lines that it printed at last
_PATIENCE_S = 5.0


def source_of(place: Any, world: World, options: DriveOptions, **placed: Any) -> Source:
    """Return where the traffic of a place comes from.

    Parameters
    ----------
    place, placed
        As of `cityx.sim.places.world_of`.
    world
        Of the place.
    options
        Whose `source` is "tracks" or "sumo".

    Raises
    ------
    InputError, UsageError
        If nothing moves there, or SUMO cannot drive there.
    """
    own = getattr(place, "city", place)
    in_memory = hasattr(own, "tracks")
    name = str(world.facts["name"])
    if options.source == SUMO:
        if in_memory or isinstance(place, (World, tuple)):
            raise UsageError(
                'source is "sumo", which reads the city from disk; give the folder it was built in.'
            )
        return Driven(store_of(place, **placed), world, options.density)
    if in_memory:
        return Recorded(own.tracks, name)
    if isinstance(place, (World, tuple)):
        raise UsageError("A world has no tracks; give the folder of the city, or the City.")
    file = store_of(place, **placed) / "tracks.npz"
    return Recorded(Tracks(**read_arrays(file)) if file.is_file() else None, name)


class Driven:
    """Vehicles that SUMO drives; a class for the process of each world.

    Parameters
    ----------
    store
        Folder of the store of the city.
    world
        Compiled of it.
    density
        Vehicles on a kilometre of lane, as traffic by rule has them.

    Raises
    ------
    UsageError
        If the world shows other lights than SUMO would.
    """

    def __init__(self, store: Path, world: World, density: float) -> None:
        self._held: dict[int, subprocess.Popen[str]] = {}
        if len(world.signal_cycle) and not (store / "signals.npz").is_file():
            raise UsageError(
                f'source is "sumo"; "{world.facts["name"]}" has signals without a plan that SUMO '
                'made. Build it with traffic: cityx build MAP "with traffic" -o DIR.'
            )
        self._store, self._density = store, density
        kilometres = float(world.piece_length[~world.across].sum()) / 1000.0
        self.most = 10 + int(2 * density * kilometres)
        if self.most > MOST:
            raise UsageError(
                f'source is "sumo"; {density:g} vehicles a kilometre may be more than {MOST} at '
                f'once on the {kilometres:.0f} km of lanes of "{world.facts["name"]}". Give a '
                f"density of {(MOST - 10) / (2 * kilometres):.2g} at most."
            )

    def begin(self, world: int, seed: int) -> float:
        """Let SUMO begin anew."""
        self._ask(world, seed % (1 << 31))
        return 0.0

    def at(self, world: int, clock: float, agents: FloatArray) -> tuple[float, Bodies]:
        """Let SUMO go on among the agents."""
        told = self._ask(world, agents[:, [0, 1, 3, 5]].tolist())
        pose = np.array([row[1:6] for row in told], float).reshape(-1, 5)
        pose[:, 3] = np.remainder(pose[:, 3] + np.pi, 2 * np.pi) - np.pi
        return clock + DT, Bodies(
            np.array([row[0] for row in told], np.int64), pose,
            np.array([row[6:9] for row in told], float).reshape(-1, 3),
            np.array([int(row[9]) for row in told], np.uint64),
            np.array([int(row[10]) for row in told], np.uint64),
        )  # fmt: skip

    def _ask(self, world: int, what: Any) -> Any:
        held = self._held.get(world)
        if held is None:
            held = self._held[world] = _started(self._store, self._density)
        assert held.stdin is not None
        try:
            held.stdin.write(json.dumps(what) + "\n")
            held.stdin.flush()
        except OSError as error:
            del self._held[world]
            raise EngineError(_ENDED) from error
        try:
            return _line_of(held)
        except EngineError:
            del self._held[world]
            raise

    def close(self) -> None:
        """End the processes, which remove their folders."""
        for held in self._held.values():
            _end(held)
        self._held.clear()

    def __del__(self) -> None:
        """End them too where nobody closed the environment."""
        self.close()


def _started(store: Path, density: float) -> subprocess.Popen[str]:
    """Return the process of SUMO, which is ready to begin."""
    from cityx.traffic.engine import sumo_environment

    path = ":".join(filter(None, sys.path))
    held = subprocess.Popen(
        [sys.executable, "-m", DRIVER, str(store.resolve()), str(density)], text=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        env=sumo_environment() | {"PYTHONPATH": path},
    )  # fmt: skip
    try:
        said = _line_of(held)
    except EngineError:
        _end(held)
        raise
    if not said.get("ready"):
        _end(held)
        kinds: Mapping[str, type[Exception]] = {
            "UsageError": UsageError, "InputError": InputError, "MissingExtra": MissingExtra,
        }  # fmt: skip
        raise kinds.get(said["kind"], EngineError)(said["message"])
    return held


def _line_of(held: subprocess.Popen[str]) -> Any:
    """Return the next answer; what else the process prints is told where it ends."""
    from cityx.traffic.live import ANSWER

    assert held.stdout is not None
    others: deque[str] = deque(maxlen=_TOLD)
    for line in held.stdout:
        if line.startswith(ANSWER):
            return json.loads(line.removeprefix(ANSWER))
        others.append(line.strip())
    raise EngineError(" ".join([_ENDED, *filter(None, others)]))


def _end(held: subprocess.Popen[str]) -> None:
    """End a process: it removes its folder where nobody asks any more."""
    try:
        held.communicate(timeout=_PATIENCE_S)
    except (subprocess.TimeoutExpired, OSError):
        held.kill()
        held.communicate()
