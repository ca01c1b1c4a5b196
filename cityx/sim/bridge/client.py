"""The client: an environment in another process, as `gymnasium.Env`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import zmq

from cityx.errors import EngineError, UsageError
from cityx.sim.bridge.addresses import checked_address, is_open
from cityx.sim.bridge.messages import packed, space_of, unpacked

PATIENCE = 600.0  # seconds; the first episode waits for the kernels to be compiled
KNOCK, GOODBYE = 5.0, 2.0  # seconds for a server to be there, and to take leave


class RemoteEnv(gymnasium.Env[Any, Any]):
    """An environment that ``cityx sim DIR --serve ADDRESS`` steps.

    Parameters
    ----------
    address
        Where it is served, ``tcp://127.0.0.1:PORT``.
    task
        As of `cityx.sim.env.CityEnv`, by its name or the word in it.
    render_mode
        As of `cityx.sim.env.CityEnv`.
    timeout
        Seconds that an answer is waited for, 600 unless told; the first picture of a place is
        compiled meanwhile. Where nobody listens at all is known after five.
    options
        The fields of the task's options; the place is that of the server.

    Attributes
    ----------
    pose
        Where the agent truly is: "x", "y", "z" and "heading" in the frame of the city, metres and
        radians, "speed" and "yaw_rate", and "seconds" of the episode.
    dt
        Seconds of a step.

    Raises
    ------
    EngineError
        If nobody answers.
    UsageError
        If the server refuses what is asked for; the message is its sentence.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array", "camera", "ansi"], "render_fps": 10}  # noqa: RUF012

    def __init__(
        self, address: str, task: str = "drive", *, render_mode: str | None = None,
        timeout: float = PATIENCE, **options: Any,
    ) -> None:  # fmt: skip
        checked_address(address, anywhere=True)
        self._address, self._timeout = address, timeout
        if not is_open(address, min(KNOCK, timeout)):
            raise EngineError(self._silence(min(KNOCK, timeout)))
        self._context = zmq.Context()
        self._socket = self._context.socket(zmq.REQ)
        self._socket.setsockopt(zmq.LINGER, 0)
        try:
            self._socket.connect(address)
        except zmq.ZMQError as error:
            self._let_go()
            raise UsageError(
                f'"{address}" is no address; it takes tcp://127.0.0.1:PORT, or ipc://FILE.'
            ) from error
        try:
            told = self._asked("make", task=task, options=options, render_mode=render_mode)
        except BaseException:
            self._let_go()
            raise
        self._env: int | None = told["env"]
        self.render_mode = render_mode
        self.task: str = told["task"]
        self.dt: float = told["dt"]
        self.pose: dict[str, float] = {}
        self.observation_space = space_of(told["observation_space"])
        self.action_space = space_of(told["action_space"])

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode: the first one of a seed, or the next one."""
        super().reset(seed=seed)
        if options:
            raise UsageError(f"reset takes no options; make takes {', '.join(sorted(options))}.")
        told = self._asked("reset", env=self._env, seed=seed)
        self.pose = told["pose"]
        return told["observation"], told["info"]

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Go on for a tenth of a second."""
        told = self._asked("step", env=self._env, action=action)
        self.pose = told["pose"]
        return (told["observation"], told["reward"], told["terminated"], told["truncated"],
                told["info"])  # fmt: skip

    def render(self) -> Any:
        """Return a picture, (h, w, 3) uint8, or a line; nothing moves by it."""
        return self._asked("render", env=self._env)["picture"]

    def close(self) -> None:
        """Let the server's environment go, and the connection; a second time does nothing."""
        if self._env is not None:
            env, self._env = self._env, None
            self._timeout = min(self._timeout, GOODBYE)
            try:
                self._asked("close", env=env)
            except EngineError:
                pass  # the server has ended, and its environments with it
            finally:
                self._let_go()

    def _asked(self, message: str, **fields: Any) -> Mapping[str, Any]:
        if self._context.closed:
            raise UsageError("The environment is closed.")
        self._socket.send(packed({"message": message, **fields}))
        if not self._socket.poll(round(1000 * self._timeout)):
            self._let_go()  # a socket that waits for an answer takes no other request
            raise EngineError(self._silence(self._timeout))
        told = unpacked(self._socket.recv())
        if not told["ok"]:
            raise UsageError(told["sentence"])
        return told

    def _silence(self, seconds: float) -> str:
        return (
            f"Nobody answers at {self._address} within {seconds:g} s; is  "
            f"cityx sim DIR --serve {self._address}  running?"
        )

    def _let_go(self) -> None:
        self._env = None
        self._socket.close()
        self._context.term()
