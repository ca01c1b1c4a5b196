"""Cameras: what agents see ahead of them, all channels from one drawing; movers included."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from cityx.city.camera import Camera, axes
from cityx.city.signals import STATES, Signals, states_at, vehicles_see
from cityx.dataset.classes import CLASS
from cityx.errors import UsageError, nearest
from cityx.geometry.arrays import FloatArray
from cityx.ids import stable_id
from cityx.sim.dynamics import DRIVEN
from cityx.sim.engine import Engine
from cityx.sim.fleet import Mixed
from cityx.sim.info import mover_name
from cityx.sim.kernels import draw, shade
from cityx.sim.kernels.tables import ALIVE, HEADING, HEIGHT, KIND, LENGTH, SPEED, WIDTH, X, Y, Z
from cityx.sim.roamers import Flyers, Roamers
from cityx.sim.scenery import DRONE, LAMPS, PERSON, POSES, Scenery
from cityx.sim.world import World
from cityx.system.cores import in_threads

CHANNELS = ("rgb", "depth", "semantic", "instance")
CAMERA = "camera"  # word for all of them
NEAR = 0.1  # metres of depth from which on something is seen, as `cityx.dataset.sight.NEAR`
FARTHEST = 2000.0  # metres of depth that are told; so deep is the sky
HELD = 0.95  # of the height of a body at which its camera is held
STANDS = 0.15  # m/s below which who walks stands
TURN_OF_LOOKS = 7  # so that who is next to each other in the list looks unlike
CURVE = 4096
# Lamps that burn by what is shown, of `cityx.city.signals.STATES`.
BURNING = np.array([{"red": 1, "red_yellow": 3, "yellow": 2}.get(name, 0 if name == "off" else 4)
                    for name in STATES], np.uint8)  # fmt: skip


@dataclass(frozen=True)
class Mount:
    """A camera of an agent.

    Attributes
    ----------
    size
        Columns and rows, pixels.
    fov
        Across, degrees.
    at
        Metres ahead, to the left and up from the middle of the agent on the ground; None for the
        middle of its front, a little below its top.
    pitch
        Degrees up.
    """

    size: tuple[int, int] = (84, 84)
    fov: float = 90.0
    at: tuple[float, float, float] | None = None
    pitch: float = 0.0


def mount_of(given: Mapping[str, Any] | None) -> Mount:
    """Return the camera that the option ``camera`` describes.

    Raises
    ------
    UsageError
        With every fault.
    """
    if given is None:
        return Mount()
    names = [each.name for each in fields(Mount)]
    if not isinstance(given, Mapping):
        raise UsageError(f"camera is {given!r}; it takes a dict of {', '.join(names)}.")
    faults = [f'A camera has no "{name}"; it has {", ".join(names)}.{nearest(str(name), names)}'
              for name in given if name not in names]  # fmt: skip
    size = _numbers(given.get("size", Mount.size), 2)
    if size is None or not all(8 <= each <= 2048 and each == int(each) for each in size):
        faults.append(f"camera size is {given['size']!r}; it takes two whole numbers, 8 to 2048.")
    for name, low, high in (("fov", 10.0, 150.0), ("pitch", -90.0, 90.0)):
        value = given.get(name, getattr(Mount, name))
        number = _numbers((value,), 1)
        if number is None or not low <= number[0] <= high:
            faults.append(f"camera {name} is {value!r}; it takes degrees, {low:g} to {high:g}.")
    at = given.get("at")
    place = None if at is None else _numbers(at, 3)
    if at is not None and (place is None or max(map(abs, place)) > 100.0):
        faults.append(f"camera at is {at!r}; it takes three metres: ahead, left and up.")
    if faults or size is None:
        raise UsageError(" ".join(faults))
    return Mount((int(size[0]), int(size[1])), float(given.get("fov", Mount.fov)),
                 None if place is None else (place[0], place[1], place[2]),
                 float(given.get("pitch", Mount.pitch)))  # fmt: skip


def _numbers(value: Any, count: int) -> list[float] | None:
    """Return so many finite numbers, None where they are none."""
    if not isinstance(value, (tuple, list, np.ndarray)) or len(value) != count:
        return None
    if not all(isinstance(each, (int, float, np.number)) and not isinstance(each, bool)
               and np.isfinite(each) for each in value):  # fmt: skip
        return None
    return [float(each) for each in value]


def spaces_of(mount: Mount) -> dict[str, Box]:
    """Return the space of each channel."""
    width, height = mount.size
    return {
        "rgb": Box(0, 255, (height, width, 3), np.uint8),
        "depth": Box(0.0, FARTHEST, (height, width), np.float32),
        "semantic": Box(0, 255, (height, width), np.uint8),
        "instance": Box(0, np.iinfo(np.uint64).max, (height, width), np.uint64),
    }


class Cameras:
    """Cameras of the agents of an engine; a class for the tables that it looks up.

    Parameters
    ----------
    engine
        Whose agents see.
    scenery
        Of its city; the engine is asked for another when its world has become another.
    mount
        Of the camera of each.
    """

    def __init__(self, engine: Engine, scenery: Scenery, mount: Mount) -> None:
        self.engine, self.mount = engine, mount
        level = np.linspace(0.0, shade.LIGHTEST, CURVE)
        held = 1.0 - np.exp(-1.35 * level)
        curve = np.where(held < 0.0031308, 12.92 * held, 1.055 * held ** (1 / 2.4) - 0.055)
        self._curve = np.round(255 * np.clip(curve, 0, 1)).astype(np.uint8)
        self._look_at(scenery)

    def _look_at(self, scenery: Scenery) -> None:
        """Look up what is drawn of the world that the engine has."""
        engine = self.engine
        self.scenery, self._world = scenery, engine.world
        movers = engine.state.real.shape[2]
        self._looks = [np.flatnonzero(scenery.figure_kind == kind)
                       for kind in range(DRONE + 1)]  # fmt: skip
        self._names = np.array([stable_id("sim", mover_name(engine, n)) for n in range(movers)],
                               np.uint64)  # fmt: skip
        self._heads = heads_of(engine.world)
        way = scenery.thing_way
        kinds = scenery.object_class[scenery.thing_object]
        self._poles = np.flatnonzero(kinds == CLASS["traffic_signal"])
        facing = -way[self._poles, :2, 1]  # lights look along -y of their poles
        length = np.maximum(np.hypot(*facing.T), 1e-9)
        self._feet, self._facing = way[self._poles, :2, 3], facing / length[:, None]
        self._burning: dict[bytes, NDArray[np.uint8]] = {}
        shown = scenery.facts["light"]
        self._towards, self._sun, self._sky = (np.array(shown[name])
                                               for name in ("towards", "sun", "sky"))  # fmt: skip
        self._visibility = float(shown["visibility"])

    def camera(self, world: int, agent: int) -> Camera:
        """Return where the camera of an agent is and what it looks at."""
        real, mount = self.engine.state.real[world, :, agent], self.mount
        at = mount.at or (real[LENGTH] / 2, 0.0, HELD * real[HEIGHT])
        c, s = np.cos(real[HEADING]), np.sin(real[HEADING])
        place = (float(real[X] + c * at[0] - s * at[1]), float(real[Y] + s * at[0] + c * at[1]),
                 float(real[Z] + at[2]))  # fmt: skip
        heading = float(np.remainder(np.pi / 2 - real[HEADING], 2 * np.pi))
        return Camera("agent", place, heading, float(np.radians(mount.pitch)),
                      float(np.radians(mount.fov)), *mount.size)  # fmt: skip

    def read(self, channels: tuple[str, ...]) -> dict[str, NDArray[Any]]:
        """Return channels of all agents, (E, A, h, w) or (E, A, h, w, 3)."""
        engine = self.engine
        if engine.world is not self._world and (scenery := engine.scenery()) is not None:
            self._look_at(scenery)
        spaces = spaces_of(self.mount)
        found = {name: np.zeros((engine.worlds, engine.agents, *spaces[name].shape),
                                spaces[name].dtype) for name in channels}  # fmt: skip

        def task(at: tuple[int, int]) -> None:
            for name, values in self.seen(self.camera(*at), *at, channels).items():
                found[name][at] = values

        pairs = [(e, n) for e in range(engine.worlds) for n in range(engine.agents)]
        in_threads(task, pairs, engine.threads)
        return found

    def seen(
        self, camera: Camera, world: int, agent: int = -1, channels: tuple[str, ...] = CHANNELS
    ) -> dict[str, NDArray[Any]]:
        """Return what a camera anywhere sees.

        Parameters
        ----------
        camera
            The camera, in the city's frame.
        world
            Of whose movers.
        agent
            Whose body it does not see, -1 for none.
        channels
            Of `CHANNELS`.

        Returns
        -------
        channels
            "rgb" (h, w, 3) uint8; "depth" (h, w) float32, metres along the view; "semantic" (h, w)
            uint8 of `cityx.dataset.classes.CLASSES`; "instance" (h, w) uint64, 0 for the sky.
        """
        own = self.scenery
        size = (camera.height, camera.width)
        close = np.empty(size, np.float32)
        thing, face = np.empty(size, np.int32), np.empty(size, np.int32)
        who, figure, way, tint = self._movers(world)
        skipped = np.flatnonzero(who == agent)
        right, down, ahead = axes(camera)
        focal = camera.width / 2 / np.tan(camera.hfov / 2)
        u, v = camera.width / 2 - 0.5, camera.height / 2 - 0.5
        rows = np.array([focal * right + u * ahead, focal * down + v * ahead, ahead])
        eye = np.array(camera.position)
        view = np.column_stack([rows, -rows @ eye])
        mesh = own.figure_mesh[figure]
        draw.draw(
            own.box, own.child, own.corner, own.thing_way, own.cluster_thing, own.cluster_node,
            own.facts["top_root"], own.top_box, own.top_child, own.top_order, own.root[mesh],
            own.bounds[mesh], way, int(skipped[0]) if len(skipped) else -1, view, NEAR, close,
            thing, face,
        )  # fmt: skip
        found: dict[str, NDArray[Any]] = {}
        if "rgb" in channels:
            image = np.empty((*size, 3), np.uint8)
            across, along = right / focal, down / focal
            rays = np.array([ahead - u * across - v * along, across, along])
            shade.paint(
                close, thing, face, own.corner, own.face_colour, own.face_tinted, own.face_lamp,
                self._lamps(world), own.thing_way,
                own.thing_tint, way, tint, eye, rays, self._towards, self._sun, self._sky,
                self._visibility, own.shade_frame, own.shade, self._curve, image,
            )  # fmt: skip
            found["rgb"] = image
        if "depth" in channels:
            with np.errstate(divide="ignore"):
                found["depth"] = np.minimum(np.float32(1.0) / close, np.float32(FARTHEST))
        if "semantic" in channels or "instance" in channels:
            still = len(own.thing_way)
            row = own.thing_object[np.clip(thing, 0, still - 1)] + own.face_part[face]
            moving = np.flatnonzero(thing.ravel() >= still)
            row = np.where((thing >= 0) & (thing < still), row, 0)
            mover = thing.ravel()[moving] - still
            for name, held, moved in (
                ("semantic", own.object_class, own.figure_class[figure]),
                ("instance", own.object_id, self._names[who]),
            ):
                if name in channels:
                    values = np.where(thing >= 0, held[row], held.dtype.type(0))
                    values.ravel()[moving] = moved[mover]
                    found[name] = values
        return {name: found[name] for name in channels}

    def _lamps(self, world: int) -> NDArray[np.uint8]:
        """Return (n,) which lamps of each thing burn; red where nobody knows what is shown."""
        moment = float(self.engine.state.clock[world])
        key = states_at(self._heads, moment).tobytes()
        found = self._burning.get(key)
        if found is None:
            found = np.zeros(len(self.scenery.thing_way), np.uint8)
            found[self._poles] = LAMPS["signal_stop"]
            if self._heads.count and len(self._poles):
                shown = vehicles_see(self._feet, self._facing, self._heads, moment)
                known = shown >= 0
                found[self._poles[known]] = BURNING[shown[known]]
            self._burning[key] = found
        return found

    def _movers(
        self, world: int
    ) -> tuple[NDArray[Any], NDArray[Any], FloatArray, NDArray[np.float32]]:
        """Return who is there, their figures, transforms (k, 3, 4) and tints (k, 3)."""
        engine, own = self.engine, self.scenery
        real, whole = engine.state.real[world], engine.state.whole[world]
        who = np.flatnonzero(whole[ALIVE] != 0)
        kind = kinds_of(engine, whole[KIND])[who]
        figure = np.empty(len(who), np.int64)
        for number in np.unique(kind).tolist():
            at = np.flatnonzero(kind == number)
            looks = self._looks[number]
            if number == PERSON:
                figure[at] = self._walking(looks, who[at], real)
            else:
                figure[at] = looks[who[at] * TURN_OF_LOOKS % len(looks)]
        x, y, z, heading = real[X, who], real[Y, who], real[Z, who], real[HEADING, who]
        c, s = np.cos(heading), np.sin(heading)
        size = np.stack([real[LENGTH, who], real[WIDTH, who], real[HEIGHT, who]], axis=1)
        scale = size / own.figure_size[figure]
        alike = kind >= PERSON  # whose arms and legs reach out of its box
        scale[alike] = scale[alike, 2:]
        way = np.zeros((len(who), 3, 4))
        way[:, 0, 0], way[:, 0, 1], way[:, 0, 3] = c * scale[:, 0], -s * scale[:, 1], x
        way[:, 1, 0], way[:, 1, 1], way[:, 1, 3] = s * scale[:, 0], c * scale[:, 1], y
        way[:, 2, 2], way[:, 2, 3] = scale[:, 2], z
        tint = np.ones((len(who), 3), np.float32)
        painted = kind < len(DRIVEN)
        tint[painted] = own.paint[who[painted] * TURN_OF_LOOKS % len(own.paint)]
        return who, figure, way, tint

    def _walking(
        self, looks: NDArray[np.int64], who: NDArray[np.int64], real: FloatArray
    ) -> NDArray[np.int64]:
        """Return the poses of people: by where they are along their heading, standing if slow."""
        own = self.scenery
        first = looks[:: POSES + 1]
        base = first[who * TURN_OF_LOOKS % len(first)]
        heading = real[HEADING, who]
        gone = real[X, who] * np.cos(heading) + real[Y, who] * np.sin(heading)
        pose = np.floor(gone / own.figure_stride[base] % 1.0 * POSES).astype(np.int64) % POSES
        stands = np.abs(real[SPEED, who]) < STANDS
        return np.asarray(base + np.where(stands, POSES, pose))


def heads_of(world: World) -> Signals:
    """Return the signals of a world as those of a city, one head for each way that is ruled."""
    piece = np.flatnonzero(world.piece_signal >= 0)
    program = world.piece_signal[piece]
    first = world.point[world.point_start[piece]]
    counts = np.diff(world.signal_start)[program]
    start = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    change = np.repeat(world.signal_start[program] - start[:-1], counts) + np.arange(start[-1])
    return Signals(
        piece.astype(np.uint64), world.piece_lane[piece], world.piece_onto[piece],
        np.zeros(len(piece), np.uint64), np.asarray(first[:, :3]), np.asarray(first[:, 3]),
        world.signal_cycle[program], start, world.signal_time[change], world.signal_state[change],
    )  # fmt: skip


def kinds_of(engine: Engine, kind: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return (N,) whose figure each mover has, of `cityx.sim.scenery`."""
    found = np.asarray(kind).copy()
    if isinstance(engine, Mixed):
        found[engine.flying] = DRONE
        found[engine.walking] += PERSON
    elif isinstance(engine, Flyers):
        found[:] = DRONE
    elif isinstance(engine, Roamers):
        found[: engine.agents] += PERSON
    found[engine.agents : engine.agents + engine.people] = PERSON
    return found
