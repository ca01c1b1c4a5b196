"""One world with one agent, as `gymnasium.Env`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from cityx.errors import UsageError, nearest
from cityx.sim.engine import DT, Engine
from cityx.sim.info import info_of, place_of
from cityx.sim.observe import Preset
from cityx.sim.options import options_of
from cityx.sim.pictures import picture
from cityx.sim.places import world_of

RENDER_MODES = ("rgb_array", "ansi")
PLACED = ("place", "text", "seed_town", "town_size")  # options that say where


def observation_space(preset: Preset) -> Box:
    """Return the space of a preset."""
    return Box(preset.low, preset.high, (preset.size,), np.float32)


def action_space() -> Box:
    """Return the space of actions: steer, then pedals or a speed."""
    return Box(-1.0, 1.0, (2,), np.float32)


def engine_of(worlds: int, threads: int, given: Mapping[str, Any]) -> Engine:
    """Make the engine of an environment from all its options."""
    own = {name: value for name, value in given.items() if name not in PLACED}
    options = options_of(own)
    world = world_of(
        given.get("place"), text=given.get("text", ""), seed=given.get("seed_town", 0),
        size=given.get("town_size"),
    )  # fmt: skip
    return Engine(world, options, worlds, threads)


def checked_action(action: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return an action as the engine takes it.

    Raises
    ------
    UsageError
        If it has another shape, or numbers that are none.
    """
    found = np.asarray(action, np.float64)
    if found.shape != shape:
        raise UsageError(f"The action has the shape {found.shape}; it takes {shape}.")
    if not np.isfinite(found).all():
        raise UsageError("The action has numbers that are not finite; it takes -1 to 1.")
    return found


class DriveEnv(gymnasium.Env[Any, Any]):
    """A vehicle that drives a route through the traffic of a city, by its rules.

    Parameters
    ----------
    place
        Folder of a built city, a map file, a `City` or a `Project`; a town is made when None.
    render_mode
        "rgb_array" for a picture from above, "ansi" for a line, None for neither.
    options
        "text", "seed_town" and "town_size" of what is built, and the fields of
        `cityx.sim.options.DriveOptions`.

    Raises
    ------
    InputError, UsageError
        If the place or an option is of no use; the message has the nearest words.
    """

    metadata: dict[str, Any] = {"render_modes": list(RENDER_MODES), "render_fps": 10}  # noqa: RUF012

    def __init__(
        self, place: Any = None, *, render_mode: str | None = None, **options: Any
    ) -> None:
        if render_mode is not None and render_mode not in RENDER_MODES:
            raise UsageError(
                f'render_mode is "{render_mode}"; known are {", ".join(RENDER_MODES)}.'
                f"{nearest(render_mode, RENDER_MODES)}"
            )
        if options.get("agents", 1) != 1:
            raise UsageError("One environment has one agent; cityx.sim.make_vec takes agents.")
        self.render_mode = render_mode
        self.engine = engine_of(1, 1, {"place": place, **options})
        self.observation_space = observation_space(self.engine.preset)
        self.action_space = action_space()
        self._seeded = False

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begin an episode: the first one of a seed, or the next one."""
        super().reset(seed=seed)
        if options:
            raise UsageError(f"reset takes no options; make takes {', '.join(sorted(options))}.")
        if seed is not None or not self._seeded:
            self.engine.seed(seed if seed is not None else int(self.np_random.integers(2**62)))
            self._seeded = True
        self.engine.begin()
        return self.engine.view[0, 0].copy(), {
            "route_m": float(self.engine.state.row("goal")[0, 0])
        }

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Drive for a tenth of a second."""
        engine = self.engine
        if not self._seeded:
            raise UsageError("Call reset before the first step.")
        engine.step(checked_action(action, (2,)).reshape(1, 1, 2), anew=False)
        out = engine.out
        return (engine.view[0, 0].copy(), float(out.reward[0, 0]), bool(out.ended[0, 0]),
                bool(out.late[0, 0]), info_of(engine, 0, 0))  # fmt: skip

    def render(self) -> Any:
        """Return a picture, (h, w, 3) uint8, or a line; nothing moves by it."""
        if self.render_mode == "rgb_array":
            return picture(self.engine, 0, 0)
        if self.render_mode == "ansi":
            x, y = place_of(self.engine, 0, 0)
            row = self.engine.state.row
            return (f"{row('speed')[0, 0]:.1f} m/s at ({x:.1f}, {y:.1f}), "
                    f"{row('gone')[0, 0]:.0f} of {row('goal')[0, 0]:.0f} m")  # fmt: skip
        return None

    def close(self) -> None:
        """Let go of the engine's threads."""
        self.engine.close()

    @property
    def dt(self) -> float:
        """Seconds of a step."""
        return DT
