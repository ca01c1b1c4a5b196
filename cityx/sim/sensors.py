"""Sensors: by name, and combined into one observation with a vector of the task."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from gymnasium.spaces import Box, Dict, Space
from numpy.typing import NDArray

from cityx.errors import UsageError, nearest
from cityx.geometry.arrays import FloatArray
from cityx.sim.cameras import CAMERA, FARTHEST, Cameras, spaces_of
from cityx.sim.cameras import CHANNELS as SEEN
from cityx.sim.engine import Engine
from cityx.sim.kernels import sense
from cityx.sim.kernels.tables import HEADING, SPEED, STEPS, YAW_RATE, X, Y, Z
from cityx.sim.options import Options
from cityx.sim.roamers import Flyers
from cityx.sim.state import DT

PIXELS, PIXEL = 96, 0.5  # of a picture from above, and metres of one
CHANNELS = ("roadway", "walk", "kerb", "solid", "movers", "route")
RINGS = np.radians(np.linspace(-15.0, 15.0, 16))
AROUND, REACH = 180, 50.0  # rays of a ring, and metres
EYE_SHARE = 0.95  # of the height of a body at which its LiDAR sits
EYES = (0.3, 1.7)  # metres above the ground between which it does
GPS_NOISE = (1.5, 1.5, 3.0)  # metres, standard deviations
IMU_NOISE = (0.05, 0.05, 0.05, 0.002, 0.002, 0.002)  # m/s2 and radians per second
GRAVITY = 9.81
SPACES: Mapping[str, Box] = {
    "bev": Box(0, 255, (len(CHANNELS), PIXELS, PIXELS), np.uint8),
    "lidar": Box(0.0, 1.0, (len(RINGS), AROUND), np.float32),
    "gps": Box(-1e6, 1e6, (3,), np.float32),
    "imu": Box(-200.0, 200.0, (6,), np.float32),
}
MEANINGS: Mapping[str, str] = {
    "bev": f"from above, the heading up, {PIXEL} m a pixel, the agent a quarter from below; "
           f"channels {', '.join(CHANNELS)}, 0 or 255",
    "lidar": f"metres / {REACH:g} by ring from -15 to 15 degrees, the first ray straight ahead, "
             "then clockwise; sides of what is solid up to 4.5 m above the ground, movers, and the "
             "ground as a plane; in the air what is highest",
    "gps": f"x, y, z in metres of the city's frame, with noise of {GPS_NOISE} m",
    "imu": "m/s2 ahead, left and up with gravity, radians per second of roll, pitch and yaw, with "
           f"noise of {IMU_NOISE[0]} m/s2 and {IMU_NOISE[3]} rad/s",
}  # fmt: skip
SEEN_MEANINGS: Mapping[str, tuple[str, str]] = {
    "rgb": ("h x w x 3 uint8", "colours in sun, shade and haze"),
    "depth": ("h x w float32", f"metres along the view; {FARTHEST:g} for the sky"),
    "semantic": ("h x w uint8", "class by the numbers of the data set; 0 for the sky"),
    "instance": ("h x w uint64", "id as in masks and reports; of movers "
                 '`stable_id("sim", "traffic:3")` and so on; 0 for the sky'),
}  # fmt: skip


def split(observation: Any, options: Options) -> tuple[str, tuple[str, ...], bool]:
    """Return the vector that is observed, the names of all, and whether they come as a Dict.

    "camera" stands for all channels of a camera.

    Raises
    ------
    UsageError
        If a name is unknown or comes twice, or there are two vectors.
    """
    vectors = options.words["observation"]
    known = (*vectors, *SPACES, *SEEN, CAMERA)
    single = isinstance(observation, str) and observation != CAMERA
    given = [observation] if isinstance(observation, str) else observation
    words = tuple(given) if isinstance(given, (list, tuple)) else ()
    names = tuple(one for word in words for one in (SEEN if word == CAMERA else (word,)))
    faults = [] if names else [f"observation is {observation!r}; it takes a name or several."]
    for name in names:
        if name not in known:
            faults.append(
                f'There is no sensor "{name}"; known are {", ".join(known)}.'
                f"{nearest(str(name), known)}"
            )
    chosen = [name for name in names if name in vectors]
    if len(chosen) > 1 or len(set(names)) < len(names):
        faults.append(f"observation is {list(names)}; it takes one vector, and each sensor once.")
    if faults:
        raise UsageError(" ".join(faults))
    return (chosen[0] if chosen else options.observation), names, not single


class Senses:
    """What agents of an engine observe; a class since an IMU remembers the last velocity.

    Attributes
    ----------
    space
        Of one agent.
    plain
        Whether it is the vector of the engine and nothing else.

    Parameters
    ----------
    engine
        Whose agents observe.
    names, together
        Of `split`.
    cameras
        Of its agents, where they have one.
    """

    def __init__(
        self, engine: Engine, names: tuple[str, ...], together: bool,
        cameras: Cameras | None = None,
    ) -> None:  # fmt: skip
        self._engine, self._names, self._together = engine, names, together
        self.cameras = cameras
        preset = engine.preset
        own = Box(preset.low, preset.high, (preset.size,), np.float32)
        held = {**SPACES, **(spaces_of(cameras.mount) if cameras is not None else {})}
        spaces: dict[str, Space[Any]] = {name: held.get(name, own) for name in names}
        self._seen = tuple(name for name in names if name in SEEN)
        self.space: Space[Any] = Dict(spaces) if together else spaces[names[0]]
        self.plain = names == (preset.name,) and not together
        self._velocity = np.zeros((engine.worlds, engine.agents, 3))
        self._held: dict[str, NDArray[Any]] = {}

    def read(self) -> None:
        """Take in what is observed now; once after each reset and each step."""
        engine = self._engine
        made: dict[str, Callable[[], NDArray[Any]]] = {
            "bev": self._above, "lidar": self._lidar, "gps": self._gps, "imu": self._imu,
        }  # fmt: skip
        seen = self.cameras.read(self._seen) if self.cameras is not None and self._seen else {}
        self._held = {
            name: seen[name] if name in seen else made[name]() if name in made else engine.view
            for name in self._names
        }

    def one(self, world: int, agent: int) -> Any:
        """Return what one agent observed."""
        parts = {name: held[world, agent].copy() for name, held in self._held.items()}
        return parts if self._together else parts[self._names[0]]

    def all(self) -> Any:
        """Return what all agents observed, one after the other."""
        parts = {name: held.reshape(-1, *held.shape[2:]).copy()
                 for name, held in self._held.items()}  # fmt: skip
        return parts if self._together else parts[self._names[0]]

    def _above(self) -> NDArray[np.uint8]:
        engine = self._engine
        shape = (engine.worlds, engine.agents, len(CHANNELS), PIXELS, PIXELS)
        found = np.zeros(shape, np.uint8)
        world, batch = engine.world, engine.state.batch
        sense.from_above(world.flags, world.clear, world.raster_frame, batch,
                         engine.agents, PIXEL, found)  # fmt: skip
        for e in range(engine.worlds):
            for n in range(engine.agents):
                sense.route_above(batch, e, n, engine.route_of(e, n), PIXEL, found[e, n, -1])
        return found

    def _lidar(self) -> NDArray[np.float32]:
        engine, world = self._engine, self._engine.world
        found = np.zeros((engine.worlds, engine.agents, len(RINGS), AROUND), np.float32)
        if isinstance(engine, Flyers):
            walks = engine.walks
            sense.sweep_tops(walks.top_height, walks.top_frame, engine.state.batch, engine.agents,
                             RINGS, REACH, found)  # fmt: skip
            return found
        eye = float(np.clip(EYE_SHARE * engine.state.row("height")[0, 0], *EYES))
        sense.sweep(world.segment, world.cell_start, world.cell_segment, world.cell_frame,
                    engine.state.batch, engine.agents, eye, RINGS, REACH, found)  # fmt: skip
        return found

    def _gps(self) -> NDArray[np.float32]:
        real = self._engine.state.real[:, :, : self._engine.agents]
        place = np.stack([real[:, X], real[:, Y], real[:, Z]], axis=-1)
        return np.asarray(place + self._noise(1, GPS_NOISE), np.float32)

    def _imu(self) -> NDArray[np.float32]:
        engine = self._engine
        real = engine.state.real[:, :, : engine.agents]
        heading = real[:, HEADING]
        c, s = np.cos(heading), np.sin(heading)
        if isinstance(engine, Flyers):
            velocity = np.stack([engine.state.row(name)[:, : engine.agents]
                                 for name in ("steer", "lift", "aside")], axis=-1)  # fmt: skip
        else:
            speed = real[:, SPEED]
            velocity = np.stack([speed * c, speed * s, np.zeros_like(speed)], axis=-1)
        steps = engine.state.whole[:, STEPS, : engine.agents]
        pushed = np.where((steps > 0)[..., None], (velocity - self._velocity) / DT, 0.0)
        self._velocity = velocity
        rate = np.zeros_like(velocity)
        rate[..., 2] = real[:, YAW_RATE]
        x, y, z = np.moveaxis(pushed, -1, 0)
        own = np.stack([x * c + y * s, y * c - x * s, z + GRAVITY], axis=-1)
        found = np.concatenate([own, rate], axis=-1) + self._noise(2, IMU_NOISE)
        return np.asarray(np.clip(found, -200.0, 200.0).astype(np.float32))

    def _noise(self, salt: int, scale: tuple[float, ...]) -> FloatArray:
        """(E, A, k) normal numbers, by the stream of the world, the agent and its step alone."""
        state, count = self._engine.state, len(scale)
        steps = state.whole[:, STEPS, : self._engine.agents].astype(np.uint64)
        agent = np.arange(self._engine.agents, dtype=np.uint64)
        code = state.key[:, None] ^ _mixed(steps * np.uint64(1 << 20) + agent)
        number = np.arange(2 * count, dtype=np.uint64) + np.uint64(salt << 8)
        bits = _mixed(code[..., None] ^ _mixed(number))
        share = ((bits >> np.uint64(11)).astype(float) + 0.5) / 9007199254740992.0
        size = np.sqrt(-2.0 * np.log(share[..., :count]))
        return np.asarray(size * np.cos(2 * np.pi * share[..., count:]) * np.array(scale))


def _mixed(value: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Scramble 64 bits, as `cityx.sim.kernels.draws.mixed` does."""
    x = value + np.uint64(0x9E3779B97F4A7C15)
    x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return np.asarray(x ^ (x >> np.uint64(31)))
