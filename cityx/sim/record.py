"""Recordings: an episode as seed, options and actions, which give it back to the bit."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from cityx.errors import InputError, UsageError
from cityx.geometry.arrays import FloatArray
from cityx.sim.engine import VERSION as ENGINE
from cityx.sim.engine import Engine
from cityx.sim.options import Options, options_of
from cityx.sim.tasks import DRIVE, begun, task_of
from cityx.sim.world import VERSION
from cityx.system.atomic import replaced
from cityx.system.packed import read_arrays, write_arrays
from cityx.version import __version__

EVERY = 50  # steps between two digests


class Recorder:
    """Takes down what an engine is told; a class for what it gathers.

    Parameters
    ----------
    engine
        Just begun, of one world.
    seed
        That it was given.
    task
        Of which it is, one of `cityx.sim.tasks.TASKS`.
    """

    def __init__(self, engine: Engine, seed: int, task: str = DRIVE) -> None:
        if engine.worlds != 1:
            raise UsageError(f"One world is recorded; the engine has {engine.worlds}.")
        self._engine, self._seed, self._task = engine, seed, task
        self._actions: list[FloatArray] = []
        self._digests = [engine.state.digests()[0]]

    def took(self, action: FloatArray) -> None:
        """Take down an action, (1, A, a), after the step that it was taken in."""
        self._actions.append(action[0].copy())
        if len(self._actions) % EVERY == 0:
            self._digests.append(self._engine.state.digests()[0])

    def write(self, path: Path) -> None:
        """Write the recording to a file (.npz)."""
        engine = self._engine
        options = {**asdict(engine.options), "reward": dict(engine.options.reward)}
        about = {
            "cityx": __version__, "world": VERSION, "engine": ENGINE, "city": engine.world.hash,
            "name": engine.world.facts["name"], "seed": self._seed, "options": options,
            "task": self._task,
        }  # fmt: skip
        actions = np.array(self._actions).reshape(-1, engine.agents, engine.action_size)
        with replaced(path) as temporary:
            write_arrays(temporary, {
                "actions": actions, "digests": np.array(self._digests),
                "end": np.array([engine.state.digests()[0]]),
                "about": np.array([json.dumps(about)]),
            })  # fmt: skip


@dataclass(frozen=True)
class Recording:
    """An episode, or several one after the other, of one world.

    Attributes
    ----------
    actions
        (t, A, a) float64.
    digests
        Hashes of the state at the beginning and after every `EVERY` steps.
    end
        That at the end.
    task, seed, options, city, version, engine
        What it was begun with, and which city, compiler of worlds and kernels it is of.
    """

    actions: FloatArray
    digests: NDArray[np.str_]
    end: str
    task: str
    seed: int
    options: Options
    city: str
    version: int
    engine: int


def read_recording(path: Path) -> Recording:
    """Read a recording.

    Raises
    ------
    InputError
        If the file is none.
    """
    try:
        held = read_arrays(path)
        about: dict[str, Any] = json.loads(str(held["about"][0]))
        task = about.get("task", DRIVE)
        options = options_of(about["options"], task_of(task).options)
        return Recording(held["actions"], held["digests"], str(held["end"][0]), task,
                         about["seed"], options, about["city"], about["world"],
                         about.get("engine", 1))  # fmt: skip
    except (OSError, ValueError, KeyError, UsageError, BadZipFile) as error:
        raise InputError(f"{path} is no recording of an episode.") from error


def replay(recording: Recording, place: Any) -> int:
    """Drive a recording again, as `driven_again` does; return how many steps there were."""
    return sum(1 for _ in driven_again(recording, place)) - 1


def driven_again(recording: Recording, place: Any) -> Iterator[Engine]:
    """Drive a recording again and compare every digest.

    Yields
    ------
    engine
        At the beginning, and after each step; it is to be read only.

    Raises
    ------
    InputError
        If the place is another one, or the state differs, with the first step where it does.
    """
    if recording.version != VERSION:
        raise InputError(
            f"The recording is of version {recording.version} of the compiler of worlds; this is "
            f"version {VERSION}, which gives a city another world."
        )
    if recording.engine != ENGINE:
        raise InputError(
            f"The recording is of version {recording.engine} of the engine; this is version "
            f"{ENGINE}, in which vehicles and people move otherwise."
        )
    engine = begun(task_of(recording.task), recording.options, place)
    if engine.world.hash != recording.city:
        raise InputError(
            f"The recording is of the city {recording.city[:16]}; this one is "
            f"{engine.world.hash[:16]}."
        )
    engine.seed(recording.seed)
    engine.begin()
    for step, action in enumerate(recording.actions):
        if step % EVERY == 0:
            _same(engine, str(recording.digests[step // EVERY]), step)
        yield engine
        engine.step(np.ascontiguousarray(action[None]))
    _same(engine, recording.end, len(recording.actions))
    yield engine


def _same(engine: Engine, digest: str, step: int) -> None:
    found = engine.state.digests()[0]
    if found != digest:
        raise InputError(
            f"The state differs from the recorded one at step {step}, or in the {EVERY} steps "
            f"before: {found} is not {digest}."
        )
