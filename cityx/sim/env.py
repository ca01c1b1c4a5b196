"""One world with one agent, as `gymnasium.Env`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from cityx.errors import UsageError, nearest
from cityx.sim.cameras import CHANNELS, Cameras, mount_of
from cityx.sim.engine import Engine
from cityx.sim.info import info_of, place_of
from cityx.sim.pictures import picture
from cityx.sim.places import scenery_of
from cityx.sim.sensors import Senses, split
from cityx.sim.state import DT
from cityx.sim.tasks import DRIVE, engine_of, placed_by, task_of
from cityx.sim.windows import Window, has_screen

RENDER_MODES = ("human", "rgb_array", "camera", "ansi")


def action_space(engine: Engine) -> Box:
    """Return the space of actions of an engine; what they mean is in `docs/simulator_tasks.md`."""
    return Box(-1.0, 1.0, (engine.action_size,), np.float32)


def sensed(
    task: str, worlds: int, threads: int, given: Mapping[str, Any], *, seen: bool = False
) -> tuple[Engine, Senses]:
    """Make the engine of a task from all its options, and what is observed of it.

    Parameters
    ----------
    task, worlds, threads
        Which task, and of the engine.
    given
        All options.
    seen
        Whether agents have a camera although none of its channels is observed.

    Raises
    ------
    InputError, UsageError
        If the place or an option is of no use.
    """
    usual = task_of(task).options
    vector, names, together = split(given.get("observation", usual.observation), usual)
    mount = mount_of(given.get("camera"))
    own = {name: value for name, value in given.items() if name != "camera"}
    engine = engine_of(task, worlds, threads, {**own, "observation": vector})
    if not seen and not set(names) & set(CHANNELS):
        return engine, Senses(engine, names, together)
    scenery = engine.scenery()
    if scenery is None:
        scenery = scenery_of(given.get("place"), engine.world, **placed_by(given))
    return engine, Senses(engine, names, together, Cameras(engine, scenery, mount))


def checked_action(action: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return an action as the engine takes it.

    Raises
    ------
    UsageError
        If it has another shape, or numbers that are none.
    """
    try:
        found = np.asarray(action, np.float64)
    except (TypeError, ValueError) as error:
        raise UsageError(
            f"The action {action!r} is no numbers; it takes {shape} of them."
        ) from error
    if found.shape != shape:
        raise UsageError(f"The action has the shape {found.shape}; it takes {shape}.")
    if not np.isfinite(found).all():
        raise UsageError("The action has numbers that are not finite; it takes -1 to 1.")
    return found


class CityEnv(gymnasium.Env[Any, Any]):
    """One agent in a city: it drives, delivers, walks, flies or explores, by its rules.

    Parameters
    ----------
    place
        Folder of a built city or of tiles, a map file, a `City` or a `Project`; a town is made when
        None.
    task
        Name of the environment, one of `cityx.sim.tasks.TASKS`.
    render_mode
        "human" for a window that shows every step in real time, "rgb_array" for a picture from
        above, "camera" for what the agent's camera sees, "ansi" for
        a line, None for none.
    options
        "text", "seed_town" and "town_size" of what is built, "at" and "town_size" of what is taken
        of tiles, or "at" and "to" for a drive over as many as it takes, of which those about the
        agent are loaded; the fields of the task's options, see
        `cityx.sim.options`, and "camera", a dict of the fields of `cityx.sim.cameras.Mount`;
        "observation" takes a name, or several for a Dict.

    Raises
    ------
    InputError, UsageError
        If the place or an option is of no use; the message has the nearest words.
    """

    # Checkers try each mode that is named here; without a screen there is no window.
    metadata: dict[str, Any] = {  # noqa: RUF012
        "render_modes": [mode for mode in RENDER_MODES if mode != "human" or has_screen()],
        "render_fps": 10,
    }

    def __init__(
        self, place: Any = None, *, task: str = DRIVE, render_mode: str | None = None,
        **options: Any,
    ) -> None:  # fmt: skip
        if render_mode is not None and render_mode not in RENDER_MODES:
            raise UsageError(
                f'render_mode is "{render_mode}"; known are {", ".join(RENDER_MODES)}.'
                f"{nearest(render_mode, RENDER_MODES)}"
            )
        if options.get("agents", 1) != 1:
            raise UsageError("One environment has one agent; cityx.sim.make_vec takes agents.")
        self.render_mode = render_mode
        self.engine, self.senses = sensed(
            task, 1, 1, {"place": place, **options}, seen=render_mode == "camera"
        )
        self.observation_space = self.senses.space
        self.action_space = action_space(self.engine)
        self._seeded = False
        self._window = Window(task, DT) if render_mode == "human" else None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode: the first one of a seed, or the next one."""
        super().reset(seed=seed)
        if options:
            raise UsageError(f"reset takes no options; make takes {', '.join(sorted(options))}.")
        if seed is not None or not self._seeded:
            self.engine.seed(seed if seed is not None else int(self.np_random.integers(2**62)))
            self._seeded = True
        self.engine.begin()
        self.senses.read()
        self._show()
        return self.senses.one(0, 0), {"route_m": self.engine.way_m(0, 0)}

    def step(self, action: NDArray[np.float32]) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Go on for a tenth of a second."""
        engine = self.engine
        if not self._seeded:
            raise UsageError("Call reset before the first step.")
        size = engine.action_size
        engine.step(checked_action(action, (size,)).reshape(1, 1, size), anew=False)
        self.senses.read()
        self._show()
        out = engine.out
        return (self.senses.one(0, 0), float(out.reward[0, 0]), bool(out.ended[0, 0]),
                bool(out.late[0, 0]), info_of(engine, 0, 0))  # fmt: skip

    def render(self) -> Any:
        """Return a picture, (h, w, 3) uint8, or a line; nothing moves by it."""
        if self.render_mode == "rgb_array":
            return picture(self.engine, 0, 0)
        if self.render_mode == "camera" and self.senses.cameras is not None:
            return self.senses.cameras.read(("rgb",))["rgb"][0, 0]
        if self.render_mode == "ansi":
            x, y = place_of(self.engine, 0, 0)
            row = self.engine.state.row
            return (f"{row('speed')[0, 0]:.1f} m/s at ({x:.1f}, {y:.1f}), "
                    f"{row('gone')[0, 0]:.0f} of {row('goal')[0, 0]:.0f} m")  # fmt: skip
        return None

    def _show(self) -> None:
        """Let who looks on see where the agent is."""
        if self._window is not None:
            self._window.show(picture(self.engine, 0, 0))

    def close(self) -> None:
        """Let go of the engine's threads, and of the window."""
        self.engine.close()
        if self._window is not None:
            self._window.close()
            self._window = None

    @property
    def dt(self) -> float:
        """Seconds of a step."""
        return DT
