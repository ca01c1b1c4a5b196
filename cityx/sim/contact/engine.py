"""The engine of robots with contacts: worlds of people and traffic in which MuJoCo moves the agent.

Each world has a window of its own about its agent. A step puts the movers there as they are, lets
MuJoCo go on for a tenth of a second, takes over where the robot is and what it touches, and lets
the kernels of walks do the rest: others move, and what happened is found and rewarded.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.errors import UsageError
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.sim.contact.robots import ROBOT, Robot
from cityx.sim.contact.window import ContactWindow
from cityx.sim.info import mover_name
from cityx.sim.kernels import roam
from cityx.sim.kernels.paths import crossing_at, height_at
from cityx.sim.kernels.tables import (
    ALIVE,
    CONTROL,
    CRASH_OBJECT,
    CRASH_VEHICLE,
    FALL,
    HEADING,
    HEIGHT,
    HELD,
    LENGTH,
    SPEED,
    WIDTH,
    YAW_RATE,
    X,
    Y,
    Z,
)
from cityx.sim.observe import WALKING, Field, Preset
from cityx.sim.options import ContactOptions, WalkOptions
from cityx.sim.roamers import Roamers
from cityx.sim.scenery import Scenery
from cityx.sim.state import DT
from cityx.sim.travellers import TRAVELLER, TRAVELLERS
from cityx.sim.walks import Walks
from cityx.sim.world import World

LYING = 0.5  # of the own up that is up at least; less is a fall
UNDER = ("ground", "kerb")  # what is touched and hit by nobody


class Contacts(Roamers):
    """Worlds of one robot each, with contacts; see `Roamers`.

    Parameters
    ----------
    world, walks, scenery
        Where they go.
    options, worlds, threads
        As of `Engine`; the options name the robot's file.

    Raises
    ------
    MissingExtra
        If MuJoCo is absent.
    InputError, UsageError
        If the robot's file is of no use, or there is no route.
    """

    options: ContactOptions

    def __init__(
        self, world: World, walks: Walks, scenery: Scenery, options: ContactOptions,
        worlds: int = 1, threads: int = 1,
    ) -> None:  # fmt: skip
        if options.agents != 1:
            raise UsageError(f"agents is {options.agents}; a world with contacts has one robot.")
        self.robot = Robot(options.robot or ROBOT)
        super().__init__(world, walks, options, worlds, threads)
        self.rules[CONTROL] = HELD
        self.action_size = self.robot.size
        self._place = world, scenery
        self._top = TRAVELLERS[TRAVELLER[options.vehicle]].top
        self._windows: list[ContactWindow | None] = [None] * worlds
        self._struck: list[int] = []  # ids of what was hit, by the numbers of `out.touched`
        self._row_of: dict[str, int] = {}
        walk = WALKING["walk"].size
        self._walk, self._last = (np.zeros((worlds, 1, walk), np.float32) for _ in range(2))

    def _preset_of(self, options: WalkOptions) -> Preset:
        del options
        place, fast = self.robot.felt
        return Preset("contact", 3, -1.0, 1.0, (
            *WALKING["walk"].fields,
            Field("up", 3, "which way is up, in the robot's own frame"),
            Field("moves", 3, "m/s ahead, left and up / 5"),
            Field("turns", 3, "radians per second about these / 10"),
            Field("joints", place, "sine and cosine of what turns, metres of what slides"),
            Field("joint_speeds", fast, "radians or metres per second / 50"),
        ))  # fmt: skip

    def window(self, world: int = 0) -> ContactWindow:
        """Return the window of a world, with MuJoCo's model and data; until its episode ends.

        Raises
        ------
        UsageError
            If no episode has begun.
        """
        found = self._windows[world]
        if found is None:
            raise UsageError("No episode has begun; reset first.")
        return found

    def _begin(self, chosen: BoolArray) -> None:
        super()._begin(chosen)
        for e in np.flatnonzero(chosen).tolist():
            self._set_down(e)

    def _set_down(self, e: int) -> None:
        real = self.state.real[e, :, 0]
        self._windows[e] = ContactWindow(
            self._place, self.robot.path, at=real[[X, Y, Z]], heading=float(real[HEADING])
        )

    def observe(self) -> None:
        """Write what the agents observe to `view`."""
        roam.observe(self.map, self.paths, self._batch, self.rules, self._walk, 1)
        for e in range(self.worlds):
            if self._windows[e] is not None:
                self._look(e, self._walk, self.view)

    def _look(self, e: int, walk: NDArray[np.float32], view: NDArray[np.float32]) -> None:
        view[e, 0] = np.concatenate([walk[e, 0], self.robot.feel(self.window(e))])

    def _step(self, action: FloatArray, final: NDArray[np.float32], low: int, high: int) -> None:
        told = np.zeros((self.worlds, 1, 3))
        for e in range(low, high):
            told[e, 0] = self._moved(e, action[e, 0])
        last = self._last if len(final) else self._last[:0]
        roam.step_worlds(
            self.map, self.paths, self._batch, self.rules, told, self.out, self._walk, last, 1,
            low, high,
        )  # fmt: skip
        for e in range(low, high):
            if len(final) and (self.out.ended[e, 0] or self.out.late[e, 0]):
                self._look(e, self._last, final)
                self._set_down(e)
            self._look(e, self._walk, self.view)

    def _moved(self, e: int, action: FloatArray) -> tuple[int, int, int]:
        """Let MuJoCo move a robot.

        Returns
        -------
        bits, touched, crossing
            What happened to it by the bits of events, the row of what it touched, and the crosswalk
            that it was on before.
        """
        real, window, robot = self.state.real[e], self.window(e), self.robot
        before = crossing_at(self.paths, real[X, 0], real[Y, 0])
        others = 1 + np.flatnonzero(self.state.whole[e, ALIVE, 1:] != 0)
        names = [mover_name(self, int(n)) for n in others]
        window.place_movers(real[[X, Y, Z, HEADING, LENGTH, WIDTH, HEIGHT]][:, others].T, names)
        window.step(robot.middle + robot.half * action.clip(-1.0, 1.0))
        place, heading = window.position, window.heading
        turned = (heading - real[HEADING, 0] + np.pi) % (2 * np.pi) - np.pi
        moved = place[:2] - real[[X, Y], 0]
        ahead = moved @ [np.cos(heading), np.sin(heading)] / DT
        ground = height_at(self.paths, place[0], place[1])
        real[[X, Y, HEADING], 0] = *place[:2], heading
        real[SPEED, 0], real[YAW_RATE, 0] = min(max(ahead, 0.0), self._top), turned / DT
        if np.isfinite(ground):
            real[Z, 0] = ground
        bits = FALL if window.upright < LYING else 0
        hit = [name for name in window.touched()
               if name not in UNDER and name not in window.loose]  # fmt: skip
        movers = [int(others[names.index(name)]) for name in hit if name in names]
        if movers:
            return bits | CRASH_VEHICLE, -2 - movers[0], before
        if hit:
            return bits | CRASH_OBJECT, self._row(hit[0]), before
        return bits, -1, before

    def _row(self, name: str) -> int:
        """Return the number of what was hit, given by its id as text."""
        if name not in self._row_of:
            self._row_of[name] = len(self._struck)
            self._struck.append(int(name, 16))
        return self._row_of[name]

    def struck(self, touched: int, agent: int = 0) -> int:  # noqa: ARG002
        """Return the id of what was hit."""
        return self._struck[touched]

    def act_by_rule(self) -> FloatArray:
        """Return what the baseline does, (E, 1, u): it drives as robots without contacts do.

        Raises
        ------
        UsageError
            If the robot does not go on wheels on its left and its right.
        """
        wanted, real = super().act_by_rule(), self.state.real
        own = TRAVELLERS[TRAVELLER[self.options.vehicle]]
        action = np.zeros((self.worlds, 1, self.robot.size))
        for e in range(self.worlds):
            turn, pace = wanted[e, 0]
            action[e, 0] = self.robot.rolled(
                (pace + 1.0) / 2.0 * own.top, turn * own.turn, float(real[e, YAW_RATE, 0])
            )
        return action
