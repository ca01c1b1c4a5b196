"""The server: it answers requests for environments of one place, one after the other."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import zmq

from cityx.errors import CityxError, UsageError
from cityx.sim.bridge.addresses import checked_address
from cityx.sim.bridge.messages import LARGEST, checked_request, packed, space_told, unpacked
from cityx.sim.env import CityEnv
from cityx.sim.kernels.tables import STEPS
from cityx.sim.registration import make
from cityx.sim.tasks import PLACED, task_of

MOST = 16  # environments at once
POLL_MS = 200  # after which it looks whether it is to end


class Desk:
    """Answers requests; a class for the environments that it holds.

    Parameters
    ----------
    place
        As of `cityx.sim.env.CityEnv`; all environments are of it.
    usual
        Options that a request need not give.
    """

    def __init__(self, place: Any, usual: Mapping[str, Any] | None = None) -> None:
        self._place, self._usual = place, dict(usual or {})
        self._held: dict[int, CityEnv] = {}
        self._over: set[int] = set()  # whose episode has not begun, or has ended
        self._last = 0

    def answer(self, raw: bytes) -> bytes:
        """Return the reply to a request; whatever is wrong with it is a sentence in the reply."""
        try:
            name, given = checked_request(unpacked(raw))
            told = getattr(self, f"_{name}")(**given)
        except CityxError as error:
            told = {"ok": False, "error": type(error).__name__, "sentence": str(error)}
            return packed(told)
        return packed({"ok": True, **told})

    def close(self) -> None:
        """Let go of all environments."""
        for env in self._held.values():
            env.close()
        self._held.clear()

    def _make(
        self, task: str, options: dict[str, Any] | None, render_mode: str | None
    ) -> dict[str, Any]:
        if len(self._held) >= MOST:
            raise UsageError(f"There are {MOST} environments already; close one first.")
        given = {**self._usual, **(options or {})}
        placed = [each for each in PLACED if each in given]
        if placed:
            raise UsageError(f"{', '.join(placed)}: the place is that of the server; leave it out.")
        env = make(task_of(task).name, self._place, render_mode=render_mode, **given)
        self._last += 1
        self._held[self._last] = env
        self._over.add(self._last)
        return {
            "env": self._last, "task": task_of(task).name,
            "observation_space": space_told(env.observation_space),
            "action_space": space_told(env.action_space), "dt": env.dt,
        }  # fmt: skip

    def _reset(self, env: int, seed: int | None) -> dict[str, Any]:
        view, info = self._env(env).reset(seed=seed)
        self._over.discard(env)
        return {"observation": view, "info": info, "pose": pose_of(self._held[env])}

    def _step(self, env: int, action: Any) -> dict[str, Any]:
        found = self._env(env)
        if env in self._over:
            raise UsageError(f"No episode of environment {env} is under way; reset it first.")
        view, reward, ended, late, info = found.step(action)
        if ended or late:
            self._over.add(env)
        return {"observation": view, "reward": reward, "terminated": ended, "truncated": late,
                "info": info, "pose": pose_of(found)}  # fmt: skip

    def _render(self, env: int) -> dict[str, Any]:
        return {"picture": self._env(env).render()}

    def _close(self, env: int) -> dict[str, Any]:
        self._env(env).close()
        del self._held[env]
        self._over.discard(env)
        return {}

    def _env(self, number: int) -> CityEnv:
        if number not in self._held:
            known = ", ".join(map(str, self._held)) or "none; make one first"
            raise UsageError(f"There is no environment {number}; known are {known}.")
        return self._held[number]


def pose_of(env: CityEnv) -> dict[str, float]:
    """Return where an agent truly is: metres, radians, m/s, radians per second, and seconds."""
    row, steps = env.engine.state.row, env.engine.state.whole[0, STEPS, 0]
    names = ("x", "y", "z", "heading", "speed", "yaw_rate")
    return {**{name: float(row(name)[0, 0]) for name in names}, "seconds": float(steps) * env.dt}


def serve(
    desk: Desk, address: str, *, anywhere: bool = False, say: Callable[[str], None],
    ends: Callable[[], bool] = lambda: False,
) -> None:  # fmt: skip
    """Answer requests until the process is interrupted, or until `ends` says so.

    Parameters
    ----------
    desk
        What answers.
    address, anywhere
        As of `checked_address`.
    say
        Called with the address once it is open.

    Raises
    ------
    UsageError
        If the address cannot be had.
    """
    address = checked_address(address, anywhere=anywhere)
    with zmq.Context() as context, context.socket(zmq.REP) as socket:
        socket.setsockopt(zmq.LINGER, 0)
        socket.setsockopt(zmq.MAXMSGSIZE, LARGEST)
        try:
            socket.bind(address)
        except zmq.ZMQError as error:
            raise UsageError(f"{address} cannot be opened: {error.strerror}.") from error
        say(socket.getsockopt_string(zmq.LAST_ENDPOINT))
        try:
            while not ends():
                if socket.poll(POLL_MS):
                    socket.send(desk.answer(socket.recv()))
        except KeyboardInterrupt:
            say("ended")
        finally:
            desk.close()
