"""Many agents in one world, of one kind or of many, as `pettingzoo.ParallelEnv`."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from secrets import randbits
from typing import Any

import numpy as np
from gymnasium.spaces import Box, Space
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from cityx.errors import UsageError, nearest
from cityx.sim.engine import Engine
from cityx.sim.env import action_space, checked_action, sensed
from cityx.sim.fleet import Mixed, names_of
from cityx.sim.info import info_of
from cityx.sim.pictures import picture
from cityx.sim.sensors import Senses
from cityx.sim.state import DT
from cityx.sim.tasks import DRIVE, fleet_of, task_of
from cityx.sim.windows import Window, has_screen

Array = NDArray[Any]
RENDER_MODES = ("human", "rgb_array")


class FleetEnv(ParallelEnv):  # type: ignore[misc]
    """Agents of one world that learn together; each leaves when its own episode ends.

    Parameters
    ----------
    place
        As of `cityx.sim.env.CityEnv`.
    agents
        How many, of one kind.
    task
        What they do, one of `cityx.sim.tasks.TASKS`.
    bodies
        Instead of these two: how many of each kind, by names of `cityx.sim.options.BODIES`. Each
        has the spaces of its task: Drive, Deliver and Walk, or Fly.
    render_mode
        "rgb_array" for a picture round the first agent that is under way, "human" for a window
        that shows it at every step in real time, None for none.
    options
        As of `cityx.sim.env.CityEnv`; with `bodies` those of `cityx.sim.options.FleetOptions`.

    Raises
    ------
    InputError, UsageError
        If the place or an option is of no use.
    """

    # Checkers try each mode that is named here; without a screen there is no window.
    metadata: dict[str, Any] = {  # noqa: RUF012
        "name": "cityx_fleet_v0",
        "render_modes": [mode for mode in RENDER_MODES if mode != "human" or has_screen()],
        "render_fps": round(1 / DT),
    }

    def __init__(
        self, place: Any = None, *, agents: int = 8, task: str = DRIVE,
        bodies: Mapping[str, int] | None = None, render_mode: str | None = None, **options: Any,
    ) -> None:  # fmt: skip
        if render_mode is not None and render_mode not in RENDER_MODES:
            raise UsageError(
                f'render_mode is "{render_mode}"; known are {", ".join(RENDER_MODES)}.'
                f"{nearest(render_mode, RENDER_MODES)}"
            )
        self.render_mode = render_mode
        self._window = Window("fleet", DT) if render_mode == "human" else None
        self._seeded = False
        self.agents: list[str] = []
        self.engine: Engine
        self.senses: Senses | None = None
        if bodies is not None:
            self.engine = mixed = fleet_of({"place": place, "bodies": bodies, **options})
            self.possible_agents = names_of(mixed.options)
            order = mixed.order.tolist()
            self._row = dict(zip(self.possible_agents, order, strict=True))
            self._actions: dict[str, Box] = {
                name: Box(-1.0, 1.0, (mixed.actions_of(row),), np.float32)
                for name, row in self._row.items()
            }
            presets = {name: mixed.preset_of(row) for name, row in self._row.items()}
            self._views: dict[str, Space[Any]] = {
                name: Box(preset.low, preset.high, (preset.size,), np.float32)
                for name, preset in presets.items()
            }
            return
        given = {"place": place, "agents": agents, **options}
        self.engine, self.senses = sensed(task, 1, 1, given)
        kind = "vehicle" if task_of(task).name == DRIVE else "agent"
        self.possible_agents = [f"{kind}_{number}" for number in range(agents)]
        self._row = {name: number for number, name in enumerate(self.possible_agents)}
        self._views = {name: deepcopy(self.senses.space) for name in self._row}
        self._actions = {name: action_space(self.engine) for name in self._row}

    def observation_space(self, agent: str) -> Space[Any]:
        """Return the space of an agent, the same object each time."""
        return self._views[agent]

    def action_space(self, agent: str) -> Space[Any]:
        """Return the space of an agent, the same object each time."""
        return self._actions[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        """Begin an episode: the first one of a seed, or the next one.

        There are no options here; PettingZoo's checker wants any to be passed over.
        """
        del options
        if seed is not None or not self._seeded:
            self.engine.seed(seed if seed is not None else randbits(62))
            self._seeded = True
        self.engine.begin()
        self.agents = list(self.possible_agents)
        self._show()
        return self._observed(self.agents), {name: {} for name in self.agents}

    def step(
        self, actions: dict[str, Array]
    ) -> tuple[
        dict[str, Any], dict[str, float], dict[str, bool], dict[str, bool],
        dict[str, dict[str, Any]],
    ]:  # fmt: skip
        """Go on for a tenth of a second.

        Raises
        ------
        UsageError
            If an agent that is under way has no action, or one of no use.
        """
        missing = [name for name in self.agents if name not in actions]
        if missing:
            raise UsageError(f"There is no action for {', '.join(missing)}.")
        taken = np.zeros((1, len(self.possible_agents), self.engine.action_size))
        for name in self.agents:
            shape = self._actions[name].shape
            taken[0, self._row[name], : shape[0]] = checked_action(actions[name], shape)
        engine, moved = self.engine, self.agents
        engine.step(taken, anew=False)
        rows = {name: (0, self._row[name]) for name in moved}
        ended = {name: bool(engine.out.ended[at]) for name, at in rows.items()}
        late = {name: bool(engine.out.late[at]) for name, at in rows.items()}
        infos = {name: info_of(engine, *at) for name, at in rows.items()}
        rewards = {name: float(engine.out.reward[at]) for name, at in rows.items()}
        self.agents = [name for name in moved if not (ended[name] or late[name])]
        for name in moved:
            if name not in self.agents:
                engine.leave(*rows[name])
        self._show()
        return self._observed(moved), rewards, ended, late, infos

    def row_of(self, agent: str) -> int:
        """Return the row of an agent in the engine's state."""
        return int(self._row[agent])

    def act_by_rule(self) -> dict[str, Array]:
        """Return what the baselines do, for each agent that is under way."""
        action = self.engine.act_by_rule()
        return {name: action[0, self._row[name], : self._actions[name].shape[0]].astype(np.float32)
                for name in self.agents}  # fmt: skip

    def _observed(self, names: list[str]) -> dict[str, Any]:
        if self.senses is None:
            assert isinstance(self.engine, Mixed)
            return {name: self.engine.view_of(0, self._row[name]) for name in names}
        self.senses.read()
        return {name: self.senses.one(0, self._row[name]) for name in names}

    def render(self) -> Any:
        """Return a picture, (h, w, 3) uint8; nothing moves by it."""
        return self._picture() if self.render_mode == "rgb_array" else None

    def _picture(self) -> NDArray[np.uint8]:
        """Return what lies round the first agent that is under way."""
        return picture(self.engine, 0, self._row[self.agents[0]] if self.agents else 0)

    def _show(self) -> None:
        """Let who looks on see it."""
        if self._window is not None:
            self._window.show(self._picture())

    def close(self) -> None:
        """Let go of the engine's threads, and of the window."""
        self.engine.close()
        if self._window is not None:
            self._window.close()
            self._window = None
