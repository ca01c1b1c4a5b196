"""Many worlds in one batch, as `gymnasium.vector.VectorEnv`; kernels step them together."""

from __future__ import annotations

from secrets import randbits
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from cityx.errors import UsageError
from cityx.sim.env import action_space, checked_action, sensed
from cityx.sim.info import infos_of
from cityx.sim.tasks import DRIVE

Array = NDArray[Any]


class CityVector(VectorEnv[Any, Array, Array]):
    """Agents in the worlds of a batch; each agent is an environment.

    Environment ``e * agents + n`` is agent n of world e. World e is, bit by bit, the single
    environment that is reset with the seed of the batch plus e. Whose episode ends begins another
    in the same step; ``info["final_obs"]`` has what it observed last.

    Parameters
    ----------
    place
        As of `cityx.sim.env.CityEnv`, as is `task`.
    num_envs
        How many environments: worlds times agents.
    threads
        That step them; the bytes do not depend on it.
    copy
        Whether observations are arrays of their own; else the next step overwrites them.
    options
        As of `cityx.sim.env.CityEnv`, and "agents".
    """

    metadata: dict[str, Any] = {"autoreset_mode": AutoresetMode.SAME_STEP}  # noqa: RUF012

    def __init__(
        self, place: Any = None, *, num_envs: int = 1, threads: int = 1, copy: bool = True,
        task: str = DRIVE, render_mode: str | None = None, **options: Any,
    ) -> None:  # fmt: skip
        agents = options.get("agents", 1)
        if num_envs < 1 or (isinstance(agents, int) and agents > 0 and num_envs % agents):
            raise UsageError(f"num_envs is {num_envs}; it takes a multiple of agents, {agents}.")
        if render_mode is not None:
            raise UsageError("A batch renders nothing; make one environment to see it.")
        self.render_mode = None
        self.engine, self.senses = sensed(
            task, num_envs // max(int(agents), 1), threads, {"place": place, **options}
        )
        if not self.senses.plain and self.engine.agents > 1:
            raise UsageError("A batch with sensors has one agent in each world.")
        self.num_envs, self._copy, self._seeded = num_envs, copy, False
        self.single_observation_space = self.senses.space
        self.single_action_space = action_space(self.engine)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode in every world: the first one of a seed, or the next one."""
        if options:
            raise UsageError(f"reset takes no options; make takes {', '.join(sorted(options))}.")
        if isinstance(seed, list):
            if len(seed) != self.engine.worlds or any(each is None for each in seed):
                raise UsageError(
                    f"Of seeds in a list, {self.engine.worlds} are taken, one a world."
                )
            self.engine.seed(0)
            self.engine.state.seed[:] = np.array(seed, np.uint64)
            self._seeded = True
        elif seed is not None or not self._seeded:
            self.engine.seed(seed if seed is not None else randbits(62))
            self._seeded = True
        self.engine.begin()
        if not self.senses.plain:
            self.senses.read()
        return self._observed(), {}

    def step(self, actions: Array) -> tuple[Any, Array, Array, Array, dict[str, Any]]:
        """Go on for a tenth of a second."""
        engine, plain = self.engine, self.senses.plain
        if not self._seeded:
            raise UsageError("Call reset before the first step.")
        taken = checked_action(actions, (self.num_envs, engine.action_size))
        engine.step(taken.reshape(engine.worlds, engine.agents, -1), anew=plain)
        out = engine.out
        ended, late = out.ended.ravel().copy(), out.late.ravel().copy()
        info = infos_of(engine)
        done = ended | late
        if not plain:
            self.senses.read()
        if done.any():
            last = np.full(self.num_envs, None, object)
            flat = engine.final.reshape(self.num_envs, -1)
            for row in np.flatnonzero(done).tolist():
                last[row] = flat[row].copy() if plain else self.senses.one(row, 0)
            if not plain:
                engine.begin(done)
                self.senses.read()
            own = {name: value for name, value in info.items() if not name.startswith("_")}
            info["final_obs"], info["_final_obs"] = last, done
            info["final_info"] = own | {f"_{name}": done for name in own}
            info["_final_info"] = done
        return self._observed(), out.reward.ravel().copy(), ended, late, info

    def _observed(self) -> Any:
        if not self.senses.plain:
            return self.senses.all()
        view = self.engine.view.reshape(self.num_envs, -1)
        return view.copy() if self._copy else view

    def close_extras(self, **_: Any) -> None:
        """Let go of the engine's threads."""
        self.engine.close()
