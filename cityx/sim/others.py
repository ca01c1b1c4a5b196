"""Others: traffic that is not driven by the kernels, but comes of tracks or of SUMO.

They count for whoever meets them as agents do: by where their bodies are, and by the lane and the
way across that they are on. What they do themselves is said elsewhere.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from cityx.city.tracks import Tracks
from cityx.errors import UsageError
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.ids import hash_bits
from cityx.sim.kernels import tables as rows
from cityx.sim.kernels.lines import PALONG, PX, PY, PZ
from cityx.sim.state import DT, State
from cityx.sim.world import World

FREE = 14.0  # metres about an agent in which nobody is when its episode begins
MOST = 1000  # that are there at once


class Bodies(NamedTuple):
    """Who is there at a moment, m in all.

    Attributes
    ----------
    name
        (m,) int64, the same for the same body from moment to moment.
    pose
        (m, 5) float64: x, y, z of the middle, heading, metres per second.
    size
        (m, 3) float64, metres.
    lane, onto
        (m,) uint64, the lane it is on and 0; on a way across the lane it comes from and the one it
        leads into; 0 and 0 where nobody knows.
    """

    name: IntArray
    pose: FloatArray
    size: FloatArray
    lane: NDArray[np.uint64]
    onto: NDArray[np.uint64]


class Source(Protocol):
    """Where others come from; `most` are there at once in one world."""

    most: int

    def begin(self, world: int, seed: int) -> float:
        """Begin an episode, and return the seconds of its clock."""

    def at(self, world: int, clock: float, agents: FloatArray) -> tuple[float, Bodies]:
        """Return who is there a step after a clock, and the clock then.

        `agents` are (n, 7): x, y, z, heading, m/s, length and width of those in the world.
        """

    def close(self) -> None:
        """Let go of what it holds."""


class Recorded:
    """Movers of tracks: they go as they went, and heed nobody. At their end they begin anew.

    Parameters
    ----------
    tracks
        Of a city.

    Raises
    ------
    UsageError
        If nothing moves there, or more than `MOST` at once.
    """

    def __init__(self, tracks: Tracks | None, name: str) -> None:
        if tracks is None or not tracks.count or tracks.duration < DT:
            raise UsageError(
                f'source is "tracks"; nothing moves in "{name}". Build it so: cityx build '
                'MAP "with traffic" -o DIR, and give that folder.'
            )
        self._frames = int(tracks.duration / DT) + 1
        own = [_resampled(tracks, row) for row in range(tracks.count)]
        frame = np.concatenate([each[0] for each in own])
        order = np.argsort(frame, kind="stable")
        self._start = np.searchsorted(frame[order], np.arange(self._frames + 1))
        self._mover = np.repeat(np.arange(tracks.count), [len(each[0]) for each in own])[order]
        self._pose = np.concatenate([each[1] for each in own])[order]
        self._lane = np.concatenate([each[2] for each in own])[order]
        self._size = np.asarray(tracks.size, float)
        self.most = int(np.diff(self._start).max())
        if self.most > MOST:
            raise UsageError(
                f'source is "tracks"; {self.most} move in "{name}" at once, {MOST} are taken.'
            )

    def begin(self, world: int, seed: int) -> float:  # noqa: ARG002
        """Draw the moment at which an episode begins."""
        return DT * (hash_bits(seed, "tracks", 0) % self._frames)

    def at(self, world: int, clock: float, agents: FloatArray) -> tuple[float, Bodies]:  # noqa: ARG002
        """Return who is there a step later."""
        frame = (round(clock / DT) + 1) % self._frames
        own = slice(self._start[frame], self._start[frame + 1])
        mover, lane = self._mover[own], self._lane[own]
        return frame * DT, Bodies(mover, self._pose[own], self._size[mover], lane[:, 0], lane[:, 1])

    def close(self) -> None:
        """Hold nothing that is to be let go."""


def _resampled(tracks: Tracks, row: int) -> tuple[IntArray, FloatArray, NDArray[np.uint64]]:
    """Return frames, poses, and lanes of a mover at each step that it is there."""
    own = slice(tracks.sample_start[row], tracks.sample_start[row + 1])
    time = tracks.time[own]
    if not len(time):
        return np.zeros(0, np.int64), np.zeros((0, 5)), np.zeros((0, 2), np.uint64)
    first, last = int(np.ceil(time[0] / DT - 1e-6)), int(np.floor(time[-1] / DT + 1e-6))
    frame = np.arange(first, last + 1)
    at = frame * DT
    columns = [*tracks.position[own].T, np.unwrap(tracks.heading[own]), tracks.speed[own]]
    pose = np.column_stack([np.interp(at, time, each) for each in columns])
    pose[:, 3] = np.remainder(pose[:, 3] + np.pi, 2 * np.pi) - np.pi
    sample = np.clip(np.searchsorted(time, at + 1e-9, side="right") - 1, 0, len(time) - 1)
    place = tracks.place[own]
    known = np.flatnonzero(place != 0)
    lane = np.column_stack([place[sample], np.zeros(len(at), np.uint64)])
    if len(known):  # between two lanes it is on the way from the one to the other
        after = np.searchsorted(known, sample)
        across = (place[sample] == 0) & (after > 0) & (after < len(known))
        lane[across, 0] = place[known[after[across] - 1]]
        lane[across, 1] = place[known[after[across]]]
    return frame, pose, lane


class Others:
    """Others as rows of a state; a class for who was left out, and what each was on before.

    Parameters
    ----------
    source
        Where they come from.
    world
        Where they are.
    first
        Their first row.
    """

    def __init__(self, source: Source, world: World, first: int) -> None:
        self.source, self.first, self.most = source, first, source.most
        self._world = world
        keys = zip(world.piece_lane.tolist(), world.piece_onto.tolist(), strict=True)
        self._piece = {key: row for row, key in enumerate(keys)}
        self._hidden: dict[int, set[int]] = {}
        self._on: dict[int, dict[int, tuple[int, int]]] = {}  # of each: its piece, the one before
        self._episode: dict[int, int] = {}

    def begin(self, state: State, chosen: BoolArray, agents: int) -> None:
        """Put those of a new episode where they are; nobody who is near an agent is there."""
        for e in np.flatnonzero(chosen).tolist():
            self._episode[e] = int(state.episode[e])
            seed = hash_bits(int(state.seed[e]), "others", self._episode[e])
            state.clock[e] = self.source.begin(e, seed)
            self._hidden[e], self._on[e] = set(), {}
            self._put(state, e, agents, begins=True)

    def step(self, state: State, agents: int) -> None:
        """Move those of every world on by one step."""
        for e in range(len(state.clock)):
            self._put(state, e, agents, begins=False)

    def begun_anew(self, state: State) -> BoolArray:
        """(E,) worlds whose episode is another one than that which these are in."""
        return np.array([self._episode.get(e) != n for e, n in enumerate(state.episode.tolist())])

    def _put(self, state: State, e: int, agents: int, *, begins: bool) -> None:
        real, whole, path = state.real[e], state.whole[e], state.path[e]
        own = [rows.X, rows.Y, rows.Z, rows.HEADING, rows.SPEED, rows.LENGTH, rows.WIDTH]
        alive = whole[rows.ALIVE, :agents] > 0
        about = real[own, :agents].T[alive]
        clock, found = self.source.at(e, float(state.clock[e]), about)
        # A kernel moves the clock on by the step that these are ahead.
        state.clock[e] = clock if begins else clock - DT
        if begins and len(about):
            apart = np.hypot(*(found.pose[:, None, :2] - about[None, :, :2]).transpose(2, 0, 1))
            self._hidden[e] = set(found.name[(apart < FREE).any(axis=1)].tolist())
        shown = ~np.isin(found.name, list(self._hidden[e]))
        count = min(int(shown.sum()), self.most)
        place = np.arange(self.first, self.first + count)
        rest = np.arange(self.first + count, self.first + self.most)
        pose, size = found.pose[shown][:count], found.size[shown][:count]
        real[:, place] = 0.0
        for row, values in zip((rows.X, rows.Y, rows.Z, rows.HEADING, rows.SPEED), pose.T,
                               strict=True):  # fmt: skip
            real[row, place] = values
        for row, values in zip((rows.LENGTH, rows.WIDTH, rows.HEIGHT), size.T, strict=True):
            real[row, place] = values
        whole[:, place] = -1
        for row in (rows.KIND, rows.AT, rows.SIZE, rows.POINT, rows.STEPS):
            whole[row, place] = 0
        whole[rows.ALIVE, place], whole[rows.ALIVE, rest] = 1, 0
        names, lanes, onto = (each[shown][:count].tolist()
                              for each in (found.name, found.lane, found.onto))  # fmt: skip
        on: dict[int, tuple[int, int]] = {}
        for n, name, key in zip(place.tolist(), names, zip(lanes, onto, strict=True), strict=True):
            piece = self._piece.get(key, -1) if key[0] else -1
            was, before = self._on[e].get(name, (-1, -1))
            before = before if piece == was else was
            on[name] = (piece, before)
            if piece < 0:
                continue
            whole[rows.PIECE, n], whole[rows.BEFORE, n] = piece, before
            path[n, 0], whole[rows.SIZE, n] = piece, 1
            self._along(real, whole, n, piece)
        self._on[e] = on

    def _along(self, real: Any, whole: Any, n: int, piece: int) -> None:
        """Say where on its piece a body is."""
        first, last = self._world.point_start[piece : piece + 2].tolist()
        point = self._world.point[first:last]
        away = (point[:, PX] - real[rows.X, n]) ** 2 + (point[:, PY] - real[rows.Y, n]) ** 2
        near = int(np.argmin(away))
        heading = point[near, 3]
        dx, dy = real[rows.X, n] - point[near, PX], real[rows.Y, n] - point[near, PY]
        c, s = np.cos(heading), np.sin(heading)
        length = float(point[-1, PALONG])
        real[rows.ALONG, n] = min(max(point[near, PALONG] + dx * c + dy * s, 0.0), length)
        real[rows.ASIDE, n] = dy * c - dx * s
        real[rows.LIFT, n] = point[near, 5]
        real[rows.LIMIT, n] = self._world.piece_speed[piece]
        whole[rows.POINT, n] = first + min(near, len(point) - 2)
        if abs(point[near, PZ] - real[rows.Z, n]) < 1.0:
            real[rows.Z, n] = point[near, PZ]  # as those have that the kernels move
