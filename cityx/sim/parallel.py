"""Many agents in one world, as `pettingzoo.ParallelEnv`."""

from __future__ import annotations

from copy import deepcopy
from secrets import randbits
from typing import Any

import numpy as np
from gymnasium.spaces import Space
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from cityx.errors import UsageError
from cityx.sim.env import action_space, checked_action, sensed
from cityx.sim.info import info_of
from cityx.sim.pictures import picture
from cityx.sim.tasks import DRIVE, task_of

Array = NDArray[Any]


class FleetEnv(ParallelEnv):  # type: ignore[misc]
    """Agents of one world that learn together; each leaves when its own episode ends.

    Parameters
    ----------
    place
        As of `cityx.sim.env.CityEnv`.
    agents
        How many.
    task
        What they do, one of `cityx.sim.tasks.TASKS`.
    render_mode
        "rgb_array" for a picture round the first agent, None for none.
    options
        As of `cityx.sim.env.CityEnv`.
    """

    metadata: dict[str, Any] = {"name": "cityx_fleet_v0", "render_modes": ["rgb_array"]}  # noqa: RUF012

    def __init__(
        self, place: Any = None, *, agents: int = 8, task: str = DRIVE,
        render_mode: str | None = None, **options: Any,
    ) -> None:  # fmt: skip
        if render_mode not in (None, "rgb_array"):
            raise UsageError(f'render_mode is "{render_mode}"; known is rgb_array.')
        self.render_mode = render_mode
        self.engine, self.senses = sensed(task, 1, 1, {"place": place, "agents": agents, **options})
        kind = "vehicle" if task_of(task).name == DRIVE else "agent"
        self.possible_agents = [f"{kind}_{number}" for number in range(agents)]
        self._row = {name: number for number, name in enumerate(self.possible_agents)}
        self.agents: list[str] = []
        self._views = {name: deepcopy(self.senses.space) for name in self._row}
        self._actions = {name: action_space(self.engine) for name in self._row}
        self._seeded = False

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
        size = self.engine.action_size
        taken = np.zeros((1, len(self.possible_agents), size))
        for name in self.agents:
            taken[0, self._row[name]] = checked_action(actions[name], (size,))
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
        return self._observed(moved), rewards, ended, late, infos

    def _observed(self, names: list[str]) -> dict[str, Any]:
        self.senses.read()
        return {name: self.senses.one(0, self._row[name]) for name in names}

    def render(self) -> Any:
        """Return a picture round the first agent, (h, w, 3) uint8; nothing moves by it."""
        return picture(self.engine, 0, 0) if self.render_mode == "rgb_array" else None

    def close(self) -> None:
        """Let go of the engine's threads."""
        self.engine.close()
