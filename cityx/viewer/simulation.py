"""A task of the simulator that runs by rule while pages look on: one picture of it a step."""

from __future__ import annotations

import json
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.sim.engine import Engine
from cityx.sim.info import happened, place_of
from cityx.sim.kernels.tables import (
    ALIVE,
    HEADING,
    HEIGHT,
    LENGTH,
    SPEED,
    WIDTH,
    X,
    Y,
    Z,
)
from cityx.sim.sensors import EYE_SHARE, EYES, REACH, RINGS, Senses
from cityx.sim.state import DT

LEVEL = int(np.argmin(np.abs(RINGS - np.radians(1.0))))  # ring of rays that is shown
EACH = 2  # rays of the ring between those that are shown
MOST_EVENTS = 40  # that a page which comes late is told
FASTEST = 10.0  # times real time
AGENT, PERSON, VEHICLE = "agent", "person", "vehicle"


class Simulation:
    """Runs episodes in a thread of its own while somebody looks on; a context manager.

    Parameters
    ----------
    engine
        Of one world.
    task
        Name of the task, for those who look on.
    episodes
        After which it pauses; going on runs as many more.
    seed
        Of the first episode.
    say
        Called with a line for each event.
    """

    def __init__(
        self, engine: Engine, task: str, *, episodes: int, seed: int, say: Callable[[str], None]
    ) -> None:
        self.listeners: list[Callable[[], None]] = []
        self._engine, self._task, self._say = engine, task, say
        self._senses = Senses(engine, ("lidar",), together=False)
        self._each, self._left = episodes, episodes
        self._episode, self._step = 1, 0
        self._paused, self._speed = False, 1.0
        self._events: deque[dict[str, Any]] = deque(maxlen=MOST_EVENTS)
        self._told = 0
        self._watched = threading.Event()
        self._going_on = threading.Condition()
        self._ending = False
        engine.seed(seed)
        engine.begin()
        self._senses.read()
        self.news = self._picture()
        self._thread = threading.Thread(target=self._run, name="cityx simulation", daemon=True)

    def __enter__(self) -> Simulation:
        """Begin; the first step waits until somebody looks on."""
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """End the thread."""
        self._ending = True
        self._watched.set()
        with self._going_on:
            self._going_on.notify_all()
        self._thread.join(5)
        self._engine.close()

    def watch(self) -> None:
        """Tell that somebody looks on; from any thread."""
        self._watched.set()

    def steer(self, *, paused: bool | None = None, speed: float | None = None) -> None:
        """Pause, go on, or run at some times real time; from any thread."""
        with self._going_on:
            if speed is not None:
                self._speed = float(np.clip(speed, 0.1, FASTEST))
            if paused is not None:
                self._paused = paused
                if not paused and not self._left:
                    self._left = self._each
            self._going_on.notify_all()
        self._publish()

    def step(self) -> None:
        """Go on by one step, and publish what came of it."""
        engine = self._engine
        route = float(engine.state.row("goal")[0, 0])
        x, y = place_of(engine, 0, 0)
        self._step += 1
        engine.step(engine.act_by_rule())
        out = engine.out
        over = bool(out.ended[0, 0] or out.late[0, 0])
        share = float(out.completion[0, 0])
        for each in happened(engine, 0, 0):
            self._told += 1
            event = {
                "number": self._told, "time": round(self._step * DT, 1), "episode": self._episode,
                "event": each["event"], "object": each.get("object", ""),
                "place": [round(x, 2), round(y, 2)], "over": over,
            }  # fmt: skip
            self._events.append(event)
            words = " ".join(filter(None, [event["event"], event["object"]]))
            self._say(f"episode {self._episode}, {event['time']} s: {words} at ({x:.1f}, {y:.1f})"
                      + (f", {share:.0%} of {route:.0f} m" if over else ""))  # fmt: skip
        if over:
            self._episode += 1
            self._left -= 1
            self._paused = self._paused or not self._left
        self._senses.read()
        self._publish()

    def _run(self) -> None:
        self._watched.wait()
        due = time.monotonic()
        while not self._ending:
            with self._going_on:
                if self._paused:
                    self._going_on.wait()
                    due = time.monotonic()
                    continue
            self.step()
            due = max(due + DT / self._speed, time.monotonic() - DT)
            time.sleep(max(due - time.monotonic(), 0.0))

    def _publish(self) -> None:
        self.news = self._picture()
        for listener in tuple(self.listeners):
            listener()

    def _picture(self) -> str:
        """Return what pages draw, as JSON: metres, radians, z up."""
        engine = self._engine
        real, whole = engine.state.real[0], engine.state.whole[0]
        route = engine.route_of(0, 0)
        height = float(real[Z, 0])
        told = {
            "task": self._task, "episode": self._episode, "time": round(self._step * DT, 1),
            "clock": round(float(engine.state.clock[0]), 2),
            "paused": self._paused, "speed": self._speed, "done": not self._left,
            "agents": engine.agents,
            "movers": [
                [kind_of(engine, n),
                 *(round(float(real[row, n]), 2) for row in (X, Y, Z)),
                 round(float(real[HEADING, n]), 3),
                 *(round(float(real[row, n]), 2) for row in (LENGTH, WIDTH, HEIGHT)),
                 round(float(real[SPEED, n]), 1)]
                for n in np.flatnonzero(whole[ALIVE]).tolist()
            ],
            "route": np.round(np.asarray(route, float), 2).tolist(),
            "completion": round(float(engine.out.completion[0, 0]), 3),
            "reward": round(float(engine.out.reward[0, 0]), 3),
            "rays": {
                "height": round(height + float(np.clip(EYE_SHARE * real[HEIGHT, 0], *EYES)), 2),
                "metres": self._rays().tolist(),
            },
            "events": list(self._events),
        }  # fmt: skip
        return json.dumps(told, separators=(",", ":"))

    def _rays(self) -> NDArray[np.float64]:
        """(k,) metres that are free round the first agent, ahead first, then clockwise."""
        return np.asarray(np.round(self._senses.one(0, 0)[LEVEL, ::EACH].astype(float) * REACH, 2))


def kind_of(engine: Engine, mover: int) -> str:
    """Return whether a mover is an agent, a person or a vehicle."""
    if mover < engine.agents:
        return AGENT
    return PERSON if mover < engine.agents + engine.people else VEHICLE
