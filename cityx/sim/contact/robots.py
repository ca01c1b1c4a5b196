"""Robots of MuJoCo as agents: what their actuators take, and what they feel of their bodies."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cityx.errors import InputError, UsageError
from cityx.geometry.arrays import FloatArray
from cityx.sim.contact.window import ContactWindow, mujoco_of

ROBOT = Path(__file__).with_name("robot.xml")  # where none is given: 30 kg on two driven wheels
FASTEST, FASTEST_TURN = 5.0, 10.0  # m/s and radians per second of a body that are 1
FASTEST_JOINT = 50.0  # radians or metres per second of a joint that are 1
TRUST = 0.5  # radians per second of turn that each one too few adds


class Robot:
    """What is known of a robot before it stands anywhere; a class for the model that it reads.

    Attributes
    ----------
    path
        Its file.
    middle, half
        (u,) float64: a control is `middle` plus `half` times an action from -1 to 1.

    Parameters
    ----------
    path
        MJCF file, as `ContactWindow` takes it.

    Raises
    ------
    MissingExtra
        If MuJoCo is absent.
    InputError
        If the file is no model, has no actuator, or one whose range of control it does not say.
    """

    def __init__(self, path: str | Path = ROBOT) -> None:
        self._mujoco = mujoco_of()
        self.path = Path(path)
        try:
            self._model = self._mujoco.MjModel.from_xml_path(str(self.path))
        except (ValueError, OSError) as error:
            raise InputError(f"{self.path} is no model of MuJoCo: {error}") from error
        model = self._model
        if not model.nu:
            raise InputError(f"{self.path} has no actuator, and an agent none to act by.")
        free = [self._names[k] for k in range(model.nu) if not model.actuator_ctrllimited[k]]
        if free:
            raise InputError(
                f"{self.path} does not say what its actuators take; give {', '.join(free)} a "
                "ctrlrange."
            )
        low, high = model.actuator_ctrlrange.T
        self.middle, self.half = (low + high) / 2, (high - low) / 2

    @property
    def size(self) -> int:
        """How many numbers an action has."""
        return int(self._model.nu)

    @cached_property
    def _names(self) -> list[str]:
        """Names of the actuators, or of the joints that they move."""
        model, found = self._model, []
        for k in range(model.nu):
            name = model.actuator(k).name
            if not name and model.actuator_trntype[k] == self._mujoco.mjtTrn.mjTRN_JOINT:
                name = model.joint(model.actuator_trnid[k, 0]).name
            found.append(name or f"actuator {k}")
        return found

    @cached_property
    def joints(self) -> list[tuple[int, int, int]]:
        """Kind, row in qpos and row in qvel of each joint but the free one."""
        model, free = self._model, self._mujoco.mjtJoint.mjJNT_FREE
        return [(int(model.jnt_type[j]), int(model.jnt_qposadr[j]), int(model.jnt_dofadr[j]))
                for j in range(model.njnt) if model.jnt_type[j] != free]  # fmt: skip

    @property
    def felt(self) -> tuple[int, int]:
        """How many numbers tell where its joints are, and how many how fast they go."""
        ball = int(self._mujoco.mjtJoint.mjJNT_BALL)
        hinge = int(self._mujoco.mjtJoint.mjJNT_HINGE)
        place = sum(4 if kind == ball else 2 if kind == hinge else 1 for kind, _, _ in self.joints)
        return place, sum(3 if kind == ball else 1 for kind, _, _ in self.joints)

    def feel(self, window: ContactWindow) -> NDArray[np.float32]:
        """Return what a robot feels in a window, between -1 and 1.

        Which way is up, how fast it moves and how fast it turns, each in its own frame; then its
        joints: sine and cosine of what turns, metres of what slides; then how fast they go.
        """
        mujoco, data, root = self._mujoco, window.data, window.root
        turn = np.empty(9)
        mujoco.mju_quat2Mat(turn, data.qpos[root.place + 3 : root.place + 7])
        own = turn.reshape(3, 3).T
        speed, spin = (data.qvel[root.speed + k : root.speed + k + 3] for k in (0, 3))
        place, fast = [], []
        for kind, at, row in self.joints:
            if kind == mujoco.mjtJoint.mjJNT_BALL:
                place += data.qpos[at : at + 4].tolist()
                fast += data.qvel[row : row + 3].tolist()
                continue
            q = float(data.qpos[at])
            hinge = kind == mujoco.mjtJoint.mjJNT_HINGE
            place += [np.sin(q), np.cos(q)] if hinge else [q]
            fast.append(float(data.qvel[row]))
        felt = np.concatenate([own[:, 2], own @ speed / FASTEST, spin / FASTEST_TURN, place,
                               np.array(fast) / FASTEST_JOINT])  # fmt: skip
        return np.asarray(felt.clip(-1.0, 1.0), np.float32)

    @cached_property
    def _wheels(self) -> tuple[FloatArray, FloatArray]:
        """(u,) metres that each driven wheel is left of the middle, and its radius."""
        model, found = self._model, []
        for k, name in enumerate(self._names):
            joint = model.actuator_trnid[k, 0]
            body = model.jnt_bodyid[joint]
            geoms = np.flatnonzero(model.geom_bodyid == body)
            side = 1.0 if "left" in name else -1.0 if "right" in name else 0.0
            aside = float(model.body_pos[body, 1])
            if not side or side * aside <= 0.0 or not len(geoms):
                raise UsageError(
                    f"By rule a robot is driven whose actuators turn wheels that are called left "
                    f"and right, and are there; those of {self.path} are {', '.join(self._names)}."
                )
            found.append((aside, float(model.geom_size[geoms, 0].max())))
        aside, radius = np.array(found).T
        return aside, radius

    def rolled(self, speed: float, turn: float, turns: float) -> FloatArray:
        """Return the action, (u,), by which wheels roll at a speed and turn at a rate.

        Parameters
        ----------
        speed, turn
            m/s and radians per second that are wanted.
        turns
            Radians per second at which it turns now: wheels slip.

        Raises
        ------
        UsageError
            If the robot has other actuators than of wheels on its left and its right.
        """
        aside, radius = self._wheels
        wanted = turn + TRUST * (turn - turns)
        control = (speed - wanted * aside) / radius
        return np.asarray(((control - self.middle) / self.half).clip(-1.0, 1.0))
