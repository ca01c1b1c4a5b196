"""Every map as an environment: built, compiled, stepped by chance; or a sentence why not."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from cityx.errors import CityxError, EngineError, InputError
from cityx.sources.input_kinds import OSM_SUFFIXES

TASKS = ("CityX/Drive-v0", "CityX/Deliver-v0")
MARK = "RAN "  # begins a line of a process that answers
RAN, REFUSED, FAILED, LONG = "ran", "refused", "failed", "too long"


@dataclass(frozen=True)
class Ran:
    """What came of one task on one map.

    Attributes
    ----------
    place, task
        Name of the map, and of the environment.
    state
        `RAN`; `REFUSED` with a sentence; `FAILED` with anything else; `LONG` where the build or
        the steps took more processor time than was given.
    told
        The sentence, or how an error reads.
    steps, ends
        Steps by chance, and episodes that ended.
    cpu
        Seconds of processor time of building, compiling and stepping, with all processes.
    """

    place: str
    task: str
    state: str
    told: str = ""
    steps: int = 0
    ends: int = 0
    cpu: float = 0.0


def maps_of(paths: Iterable[Path]) -> list[Path]:
    """Return the maps among files and in folders, the smallest first.

    Raises
    ------
    InputError
        If there is none.
    """
    found = {each for path in paths for each in ([path] if path.is_file() else path.glob("*"))
             if each.name.lower().endswith(OSM_SUFFIXES)}  # fmt: skip
    if not found:
        raise InputError(f"There is no map in {', '.join(map(str, paths))}.")
    return sorted(found, key=lambda each: (each.stat().st_size, each.name))


def sweep(
    maps: Sequence[Path], steps: int, limit: int, say: Callable[[str], None],
    tasks: Sequence[str] = TASKS,
) -> list[Ran]:  # fmt: skip
    """Step each task on each map by chance, each map in a process of its own.

    Parameters
    ----------
    maps, steps, tasks
        Where, how long, and what.
    limit
        Seconds of processor time of each process that a map takes.
    say
        Called with a line for each task on each map.
    """
    found: list[Ran] = []
    for path in maps:
        for one in _in_process(path, steps, limit, tasks):
            found.append(one)
            say(line_of(one))
    return found


def line_of(one: Ran) -> str:
    """Return what came of a task on a map as a line."""
    ran = f"{one.steps} steps, {one.ends} ends" if one.state == RAN else one.told
    return f"{one.place:<36} {one.task.split('/')[1]:<12} {one.cpu:6.1f} s  {one.state}: {ran}"


def _in_process(path: Path, steps: int, limit: int, tasks: Sequence[str]) -> list[Ran]:
    """Step the tasks of a map in another process, whose processes have so much time each."""
    command = [sys.executable, "-m", "cityx_bench.sim_maps", str(path), str(steps), str(limit),
               *tasks]  # fmt: skip
    before = _spent()
    done = subprocess.run(
        command, capture_output=True, text=True, check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5)),
    )  # fmt: skip
    lines = [line for line in done.stdout.splitlines() if line.startswith(MARK)]
    found = [Ran(**json.loads(line.removeprefix(MARK))) for line in lines]
    if len(found) < len(tasks):
        words = (done.stderr.strip().splitlines() or ["it ended without a word"])[-1]
        state = LONG if done.returncode < 0 and _spent() - before >= limit - 2 else FAILED
        told = f"more than {limit} s of processor time" if state == LONG else words
        found += [Ran(path.name, task, state, told, cpu=_spent() - before)
                  for task in tasks[len(found) :]]  # fmt: skip
    return found


def _spent() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def step_one(path: Path, task: str, steps: int, limit: int) -> Ran:
    """Step one task on one map by chance; every observation is held to its space."""
    import cityx

    begun = time.process_time() + _spent()
    env: Any = None
    ends = 0
    try:
        env = cityx.make(task, path)
        env.action_space.seed(0)
        view, _ = env.reset(seed=0)
        for _ in range(steps):
            view, reward, ended, late, _ = env.step(env.action_space.sample())
            if view not in env.observation_space or reward != reward:
                raise ValueError(f"what is observed, or rewarded ({reward}), is out of its space")
            if ended or late:
                ends += 1
                env.reset()
        state, told = RAN, ""
    except CityxError as error:
        # A maker that was ended at the limit leaves no words.
        long = isinstance(error, EngineError) and _spent() >= limit - 2
        state, told = (LONG, f"more than {limit} s") if long else (REFUSED, str(error))
    except Exception as error:  # noqa: BLE001  (whatever it is, it is to be counted)
        state, told = FAILED, f"{type(error).__name__}: {error}"
    finally:
        if env is not None:
            env.close()
    spent = time.process_time() + _spent() - begun
    return Ran(path.name, task, state, told, steps if state == RAN else 0, ends, round(spent, 1))


def _main() -> None:
    path, steps, limit, *tasks = sys.argv[1:]
    for task in tasks:
        one = step_one(Path(path), task, int(steps), int(limit))
        sys.stdout.write(f"\n{MARK}" + json.dumps(asdict(one)) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    _main()
