"""Journeys: one drive over many tiles, of which only those about the vehicle are loaded.

The way is known from the lanes of all tiles between its ends, as metres to go from each. What is
driven in is the world of a tile and its neighbours. In the next tile the world of that and its
neighbours takes over: vehicle, clock and the traffic that is in both worlds go on as they are.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.errors import InputError, UsageError
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.ids import hash_bits
from cityx.sim.baseline import end_of
from cityx.sim.engine import Engine
from cityx.sim.kernels import tables as rows
from cityx.sim.kernels.tables import Outcome
from cityx.sim.kernels.traffic import STUCK, UNSEEN
from cityx.sim.options import RULES, DriveOptions
from cityx.sim.scenery import Scenery
from cityx.sim.state import DT, LONGEST, State
from cityx.sim.tasks import JOURNEY_STEPS
from cityx.sim.world import World
from cityx.tiles.grid import Box, Tile, tile_at
from cityx.tiles.joining import region_scenery, region_world
from cityx.tiles.order import read_order
from cityx.tiles.plane import origin_of
from cityx.tiles.region import Region, place_of, region_about
from cityx.tiles.ways import corridor, ends_of, metres_to

RIM = 6.0  # metres from the border of what is loaded at which a lane leads out of it
FREE, FAR = 14.0, 60.0  # metres from others, and from the vehicle, at which traffic comes anew
WITHIN = 60.0  # metres from that border at which a world has every turn that there is
LEFT = 0.5  # metres of a way that are not driven
STARTS = 6.0  # metres of its first lane that a vehicle has behind it
STANDS, STUCK_S = 0.1, 300.0  # m/s, and seconds at less of them after which a journey is given up
LOCKED_S = 90.0  # seconds of standing after which traffic about it that stands too makes way
SAME = 1e-3  # metres within which a lane of two worlds is the same line
Say = Callable[[str], None]


@dataclass(frozen=True)
class Trip:
    """What came of a journey.

    Attributes
    ----------
    end
        "goal", an event by the names of the engine, "no way", "stuck" or "late".
    metres, to_go
        Driven, and of the way when it began.
    track
        (n, 4) float64: seconds, x, y in metres of the frame, m/s, at each step.
    tiles
        Those that were driven through, in order.
    shared, same
        Pieces of lanes, by their ids, that a world and the next one both have, and how many of
        them are the same line; summed over the borders that were crossed.
    """

    end: str
    metres: float
    to_go: float
    track: FloatArray
    tiles: tuple[str, ...]
    shared: int
    same: int

    @property
    def digest(self) -> str:
        """32 hexadecimal digits over every bit of the track."""
        return blake2b(np.ascontiguousarray(self.track).tobytes(), digest_size=16).hexdigest()


def journey(
    folder: Path, start: tuple[float, float], goal: tuple[float, float], *,
    options: DriveOptions | None = None, seed: int = 0, say: Say = lambda _: None,
) -> Trip:  # fmt: skip
    """Drive from a place to another by rule; tiles that are missing are built on the way.

    Parameters
    ----------
    folder
        Of tiles.
    start, goal
        Metres of the map or of the plane.
    options
        Of the drive; what they say of routes and of the horizon does not count.
    seed
        Of the traffic.

    Raises
    ------
    InputError, UsageError
        As of `Journey`.
    """
    told = {**vars(options or DriveOptions()), "horizon": JOURNEY_STEPS}
    engine = Journey(folder, start, goal, DriveOptions(**told), say=say)
    engine.seed(seed)
    engine.begin()
    track: list[tuple[float, ...]] = []
    end, moved = "late", 0
    while not (engine.out.ended[0, 0] or engine.out.late[0, 0]):
        engine.step(engine.act_by_rule(), anew=False)
        x, y, speed = engine.state.real[0, [rows.X, rows.Y, rows.SPEED], 0].tolist()
        track.append((round(len(track) * DT, 6), x, y, speed))
        moved = len(track) if speed > STANDS else moved
        if (len(track) - moved) * DT > STUCK_S:
            end = "stuck"
            break
    if engine.out.ended[0, 0]:
        end = end_of(engine, int(engine.out.event[0, 0]))
    way = np.array(track).reshape(-1, 4)
    return Trip(
        "no way" if engine.lost else end, float(np.hypot(*np.diff(way[:, 1:3], axis=0).T).sum()),
        engine.way_m(0, 0), way, tuple(each.name for each in engine.tiles), *engine.lines,
    )  # fmt: skip


def journey_engine(place: str | Path, at: str, to: str, options: DriveOptions) -> Journey:
    """Return the engine of a journey, as `cityx.sim.tasks.engine_of` asks for it.

    Parameters
    ----------
    place
        Folder of tiles.
    at, to
        Its ends, as `cityx.tiles.region.place_of` takes them.
    options
        Of the drive.

    Raises
    ------
    InputError, UsageError
        As of `Journey`.
    """
    order, _ = read_order(Path(place))
    ends = place_of(order, at), place_of(order, to, "to")
    return Journey(Path(place), *ends, options)


class Journey(Engine):
    """A vehicle on its way over tiles in a world that follows it; see `Engine`.

    The state, the map and the observed arrays are others after a border. Where no way leads on an
    episode is cut off.

    Attributes
    ----------
    tiles
        Through which the vehicle came in this episode, in order.
    lines
        As `Trip.shared` and `Trip.same`.
    lost
        Whether no way leads on.

    Parameters
    ----------
    folder
        Of tiles.
    start, goal
        Metres of the map or of the plane.
    options
        Of the drive; how long a route is does not count.
    say
        Is told of what is loaded.

    Raises
    ------
    InputError, UsageError
        If there is no lane at an end, or no way, or options ask for what a journey has not.
    """

    def __init__(
        self, folder: Path, start: tuple[float, float], goal: tuple[float, float],
        options: DriveOptions, *, say: Say = lambda _: None,
    ) -> None:  # fmt: skip
        faults = [
            f"{name} is {getattr(options, name)!r}; a journey takes {usual!r}."
            for name, usual in (("agents", 1), ("people", 0), ("source", RULES))
            if getattr(options, name) != usual
        ]
        if faults:
            raise UsageError(" ".join(faults))
        order, _ = read_order(folder)
        self._folder, self._size, self._say = folder, order.size, say
        self._asked = options
        origin = origin_of(order, tile_at(*start, order.size))
        self._origin = np.array(origin, float)  # of the frame on the plane
        self._streets = corridor(folder, start, goal)
        self._start, self._place = (tuple((np.array(at) - self._origin).tolist())
                                    for at in (start, goal))  # fmt: skip
        self._ends = ends_of(self._streets, self._start, self._place)
        self._forget()
        self._say(f"{self._whole:,.0f} m to go")
        self._tile = tile_at(*start, self._size)
        self._load(self._tile)

    def _forget(self) -> None:
        """Begin with what lanes alone say of the way."""
        self._lane, (self._goal, *self._others), self._to_go = self._ends
        self._whole = self._to_go[self._lane]
        self._turns: dict[int, set[int]] = {}  # of lanes that were loaded: where they lead
        self._last = self._cut = False  # whether the way ends at the goal, or is longer than held
        self._gone = self._beyond = 0.0  # metres before this way, and after it
        self.tiles: list[Tile] = []
        self.lines = (0, 0)
        self.lost = False

    def _tile_at(self, place: FloatArray) -> Tile:
        x, y = (place + self._origin).tolist()
        return tile_at(x, y, self._size)

    def _region(self) -> Region:
        west, south, east, north = self._tile.box(self._size)
        middle = ((west + east) / 2, (south + north) / 2)
        return region_about(self._folder, middle, (2 * self._size, 2 * self._size))

    def _load(self, tile: Tile) -> None:
        """Take the world of a tile and its neighbours; all that an engine has is made anew."""
        self._tile = tile
        region = self._region()
        self._box = _within(region.box, self._origin)
        self._say(f"in {tile.name}, {len(region.tiles)} tiles loaded")
        super().__init__(region_world(region), self._asked)

    def scenery(self) -> Scenery:
        """Return what a camera sees of the tiles that are loaded.

        Raises
        ------
        InputError, UsageError
            If they cannot be joined.
        """
        return region_scenery(self._region())

    def way_m(self, world: int, agent: int) -> float:  # noqa: ARG002
        """Return the metres of the whole way."""
        return self._whole

    def _begin(self, chosen: BoolArray) -> None:
        if not chosen[0]:
            return
        state = self.state
        self._seed, self._episode = int(state.seed[0]), int(state.episode[0])
        self._forget()
        first = self._tile_at(np.array(self._start))
        if first != self._tile:
            self._load(first)
        self.tiles.append(first)
        self._populate()
        for array in (self.out.ended, self.out.late):
            array[:] = False
        if not self._set_out(self._lane):
            raise InputError(
                f"A {self._asked.vehicle} fits along no way from the one place to the other."
            )

    def _populate(self) -> None:
        """Draw the traffic of what is loaded, by the seed, the episode and the tile."""
        state, tile = self.state, self._tile
        own = self._seed if not self._episode else hash_bits(self._seed, "episode", self._episode)
        state.seed[0] = hash_bits(own, "journey", tile.column, tile.row)
        state.episode[0] = 0
        super()._begin(np.ones(1, bool))
        state.seed[0], state.episode[0] = self._seed, self._episode + 1

    def step(self, action: FloatArray, *, anew: bool = True) -> None:
        """Step the world, and load the next one behind a border; see `Engine.step`."""
        super().step(action, anew=False)
        if self.state.real[0, rows.WAITED, 0] > LOCKED_S:
            _unlock(self.state)
        self._go_on()
        if anew and (self.out.ended[0, 0] or self.out.late[0, 0]):
            out, seen = self.out, self.view.copy()
            self.out = Outcome(*(np.array(each) for each in out))
            self.begin()
            self.out = out
            self.final[...] = seen

    def _go_on(self) -> None:
        """Lead the vehicle on where its way ends or another tile begins."""
        out, state = self.out, self.state
        arrived = bool(out.event[0, 0] & rows.GOAL_REACHED)
        if arrived and not self._last:  # at the end of what it is led along, and no farther
            out.event[0, 0] &= ~rows.GOAL_REACHED
            out.reward[0, 0] -= out.term[rows.SUCCESS, 0, 0]
            out.term[rows.SUCCESS, 0, 0] = 0.0
            out.ended[0, 0] = False
        if not (out.ended[0, 0] or out.late[0, 0]):
            here = self._tile_at(state.real[0, [rows.X, rows.Y], 0])
            ahead = int(state.whole[0, rows.SIZE, 0] - state.whole[0, rows.AT, 0])
            if here != self._tile:
                self.lost = not self._take_over(here)
            elif self._cut and (arrived or ahead < LONGEST // 2):
                self.lost = not self._lead_on()
            elif arrived and not self._last:
                self.lost = True
        if self.lost:
            self.out.late[0, 0] = True
            self.out.event[0, 0] |= rows.LATE
        gone, goal = self.state.real[0, [rows.GONE, rows.GOAL], 0].tolist()
        done = self._gone + gone
        left = max(goal - gone, 0.0) + self._beyond
        self.out.completion[0, 0] = done / max(done + left, 1e-6)

    def _set_out(self, lane: int) -> bool:
        """Put the vehicle on a lane with its way before it."""
        world = self.world
        piece = _rows_by_key(world).get((lane, 0))
        kind = int(self.state.whole[0, rows.KIND, 0])
        self._learn(kind)
        path = None if piece is None else self._way(piece, kind)
        if piece is None or path is None:
            return False
        real, first = self.state.real[0], int(world.point_start[piece])
        points = world.point[first : world.point_start[piece + 1]]
        at = int(np.searchsorted(points[:, 4], min(STARTS, points[-1, 4] / 2)))
        real[[rows.X, rows.Y, rows.Z, rows.HEADING, rows.ALONG, rows.LIFT], 0] = points[at]
        for row in (rows.SPEED, rows.STEER, rows.ASIDE, rows.TURNED):
            real[row, 0] = 0.0
        _lead(self, 0, path, at)
        self.state.whole[0, rows.STEPS, 0] = 0
        self._end_way(path)
        _clear(self.state, 1)
        return True

    def _lead_on(self) -> bool:
        """Lead the vehicle farther in the same world; whether a way does."""
        whole, real = self.state.whole[0], self.state.real[0]
        piece = int(self.state.path[0, 0, whole[rows.AT, 0]])
        kind = int(whole[rows.KIND, 0])
        path = self._way(piece, kind)
        if path is None or (len(path) == 1 and not self._last):
            return False
        self._gone += float(real[rows.GONE, 0])
        kept = [int(whole[row, 0]) for row in (rows.POINT, rows.BEFORE, rows.CLEARED, rows.STEPS)]
        _lead(self, 0, path, kept[0] - int(self.world.point_start[piece]))
        for row, value in zip((rows.BEFORE, rows.CLEARED, rows.STEPS), kept[1:], strict=True):
            whole[row, 0] = value
        self._end_way(path)
        return True

    def _take_over(self, tile: Tile) -> bool:
        """Load the world about another tile, in which everything goes on; whether a way does."""
        before, was, out = self.world, self.state, self.out
        steps = int(was.whole[0, rows.STEPS, 0])
        self._gone += float(was.real[0, rows.GONE, 0])
        old_box = self._box
        self.tiles.append(tile)
        self._load(tile)
        self.out = out
        self._populate()
        known = _rows_by_key(self.world)
        shared, same = _lines(before, self.world, known, _overlap(old_box, self._box))
        self.lines = self.lines[0] + shared, self.lines[1] + same
        state = self.state
        state.clock[0] = was.clock[0]
        mover = 0
        for n in range(was.real.shape[2]):
            if not was.whole[0, rows.ALIVE, n] or mover == state.real.shape[2]:
                continue
            path = _carried(before, was, n, known)
            if n == 0:
                kind = int(was.whole[0, rows.KIND, 0])
                self._learn(kind)
                path = (self._way(path[0], kind) if path else None) or []
                if not path:
                    return False
            if not path:
                continue
            piece = int(was.path[0, n, was.whole[0, rows.AT, n]])
            at = int(was.whole[0, rows.POINT, n] - before.point_start[piece])
            state.real[0, :, mover] = was.real[0, :, n]
            for row in (rows.KIND, rows.ALIVE):
                state.whole[0, row, mover] = was.whole[0, row, n]
            _lead(self, mover, path, at)
            for row in (rows.BEFORE, rows.CLEARED):
                there = _row_in(before, int(was.whole[0, row, n]), known)
                state.whole[0, row, mover] = -1 if there is None else there
            mover += 1
        state.whole[0, rows.STEPS, 0] = steps
        self._end_way(state.path[0, 0, : state.whole[0, rows.SIZE, 0]].tolist())
        _clear(state, mover)
        self.observe()
        return True

    def _learn(self, kind: int) -> None:
        """Keep where lanes lead for a kind of vehicle, as a world shows it.

        A world knows where it does not fit, which lanes do not say. What is loaded later would
        lead back there, and be found closed again.
        """
        world, lanes = self.world, self._streets
        usable = self.map.usable[:, kind] > 0
        source = np.repeat(np.arange(world.count), np.diff(world.next_start))
        both = usable[source] & usable[world.next] & ~world.across[source]
        source, target = source[both], world.next[both]
        onto = np.where(world.across[target], world.piece_onto[target], world.piece_lane[target])
        west, south, east, north = self._box
        ends = lanes.points[lanes.point_start[1:] - 1, :2]
        inside = ((ends > (west + WITHIN, south + WITHIN))
                  & (ends < (east - WITHIN, north - WITHIN))).all(axis=1)  # fmt: skip
        shown = set(lanes.lane_id[inside].tolist()) & set(world.piece_lane[~world.across].tolist())
        turns: dict[int, set[int]] = {key: set() for key in shown}
        for one, other in zip(world.piece_lane[source].tolist(), onto.tolist(), strict=True):
            if one in turns:
                turns[one].add(other)
        if any(self._turns.get(key) != onward for key, onward in turns.items()):
            self._turns |= turns
            self._to_go = metres_to(lanes, self._goal, self._turns)

    def _way(self, piece: int, kind: int) -> list[int] | None:
        """Return the pieces from one on to the goal, or to where least is left; None if none.

        Where none leads to the lane nearest to the place the next one there is gone to.
        """
        while (path := self._way_to(piece, kind)) is None and self._others:
            self._goal = self._others.pop(0)
            self._to_go = metres_to(self._streets, self._goal, self._turns)
        return path

    def _way_to(self, piece: int, kind: int) -> list[int] | None:
        from scipy.sparse import csr_matrix
        from scipy.sparse.csgraph import dijkstra

        world = self.world
        usable = self.map.usable[:, kind] > 0
        usable[piece] = True
        source = np.repeat(np.arange(world.count), np.diff(world.next_start))
        both = usable[source] & usable[world.next]
        source, target = source[both], world.next[both]
        cost = np.maximum(world.piece_length[source], 1e-3)
        graph = csr_matrix((cost, (source, target)), (world.count, world.count))
        away, back = dijkstra(graph, indices=piece, return_predecessors=True)
        lane = np.flatnonzero(np.isfinite(away) & ~world.across)
        left = np.array([self._to_go.get(key, np.inf) for key in world.piece_lane[lane].tolist()])
        goal = world.piece_lane[lane] == np.uint64(self._goal)
        if not goal.any():
            ends = world.point[world.point_start[lane + 1] - 1, :2]
            west, south, east, north = self._box
            out = ((ends < (west + RIM, south + RIM)) | (ends > (east - RIM, north - RIM))).any(
                axis=1
            )
            goal = out & np.isfinite(left)
        if not goal.any():
            return None
        lane, left = lane[goal], left[goal]
        # Of several ways that are as long the one of which more is known; then by id.
        order = np.lexsort((world.piece_lane[lane], left, np.round(away[lane] + left, 3)))
        best = int(lane[order[0]])
        path = [best]
        while path[-1] != piece:
            path.append(int(back[path[-1]]))
        self._cut = len(path) > LONGEST
        self._last = int(world.piece_lane[best]) == self._goal and not self._cut
        length = world.piece_length[path[: len(path) - LONGEST]] if self._cut else np.zeros(0)
        self._beyond = float(length.sum())
        if not self._last:
            self._beyond += max(float(left[order[0]] - world.piece_length[best]), 0.0)
        return path[::-1][:LONGEST]

    def _end_way(self, path: list[int]) -> None:
        """Say how far the vehicle is led."""
        real, world = self.state.real[0], self.world
        length = float(world.piece_length[path].sum())
        if self._last:
            first, end = world.point_start[[path[-1], path[-1] + 1]].tolist()
            lane = world.point[first:end]
            near = np.argmin(np.hypot(*(lane[:, :2] - self._place).T))
            length -= float(lane[-1, 4] - lane[near, 4])
        real[rows.GOAL, 0] = max(length - real[rows.ALONG, 0] - LEFT, LEFT)
        real[rows.GONE, 0] = 0.0


def _within(box: Box, origin: FloatArray) -> Box:
    """Return a rectangle of the plane in the frame that has this origin."""
    x, y = origin.tolist()
    return box[0] - x, box[1] - y, box[2] - x, box[3] - y


def _overlap(one: Box, other: Box) -> Box:
    return (max(one[0], other[0]), max(one[1], other[1]), min(one[2], other[2]),
            min(one[3], other[3]))  # fmt: skip


def _lines(
    before: World, after: World, known: dict[tuple[int, int], int], box: Box
) -> tuple[int, int]:
    """Count the pieces of two worlds with one id well within a box, and those that are one line."""
    shared = same = 0
    west, south, east, north = box
    ids = zip(before.piece_lane.tolist(), before.piece_onto.tolist(), strict=True)
    starts, theirs = before.point_start.tolist(), after.point_start.tolist()
    for row, key in enumerate(ids):
        points = before.point[starts[row] : starts[row + 1], :3]
        low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
        if (low < (west + WITHIN, south + WITHIN)).any() or (
            high > (east - WITHIN, north - WITHIN)
        ).any():
            continue
        shared += 1
        there = known.get(key)
        if there is not None:
            other = after.point[theirs[there] : theirs[there + 1], :3]
            same += bool(points.shape == other.shape and (np.abs(points - other) < SAME).all())
    return shared, same


def _rows_by_key(world: World) -> dict[tuple[int, int], int]:
    """Return the pieces of a world by their lane, and the lane that ways across lead into."""
    keys = zip(world.piece_lane.tolist(), world.piece_onto.tolist(), strict=True)
    return {key: row for row, key in enumerate(keys)}


def _row_in(world: World, piece: int, known: dict[tuple[int, int], int]) -> int | None:
    """Return the row of a piece in another world, None where that does not have it."""
    if piece < 0:
        return None
    return known.get((int(world.piece_lane[piece]), int(world.piece_onto[piece])))


def _carried(world: World, state: State, n: int, known: dict[tuple[int, int], int]) -> list[int]:
    """Return the way of a mover from its piece on in another world, as far as that has it."""
    whole = state.whole[0]
    ahead: Any = state.path[0, n, whole[rows.AT, n] : whole[rows.SIZE, n]].tolist()
    found: list[int] = []
    for piece in ahead:
        row = _row_in(world, piece, known)
        if row is None:
            break
        found.append(row)
    return found


def _lead(engine: Engine, mover: int, path: list[int], point: int) -> None:
    """Give a mover a way whose first piece it is on, near a point of that."""
    state, world = engine.state, engine.world
    whole = state.whole[0]
    first, last = (int(world.point_start[path[0] + end]) for end in (0, 1))
    state.path[0, mover] = -1
    state.path[0, mover, : len(path)] = path
    whole[rows.AT, mover], whole[rows.SIZE, mover] = 0, len(path)
    whole[rows.PIECE, mover] = path[0]
    whole[rows.POINT, mover] = min(first + point, last - 2)
    whole[rows.BEFORE, mover] = whole[rows.CLEARED, mover] = -1
    if mover:
        whole[rows.STEPS, mover] = -1  # who counts no steps is no agent


def _unlock(state: State) -> None:
    """Let traffic that has stood long go elsewhere, though it is seen.

    Out of sight it does so by itself. Where vehicles wait for each other round a junction and the
    journey stands among them, none of them is out of sight. Where that does not help, since others
    come and wait in their stead, all that stand go.
    """
    real, whole = state.real[0], state.whole[0]
    away = np.hypot(real[rows.X] - real[rows.X, 0], real[rows.Y] - real[rows.Y, 0])
    least = STUCK if real[rows.WAITED, 0] < 2 * LOCKED_S else 0.0
    gone = (away < UNSEEN) & (real[rows.WAITED] > least) & (whole[rows.ALIVE] > 0)
    gone[0] = False
    whole[rows.ALIVE, gone] = 0
    real[rows.WAITED, gone] = 0.0


def _clear(state: State, carried: int) -> None:
    """Take the traffic that was drawn anew out of the way of what was there."""
    real, whole = state.real[0], state.whole[0]
    place: NDArray[np.float64] = real[[rows.X, rows.Y]].T
    fresh: IntArray = np.arange(carried, len(place))
    apart = np.hypot(*(place[fresh, None] - place[None, :carried]).transpose(2, 0, 1))
    gone = (apart < FREE).any(axis=1) | (apart[:, 0] < FAR)
    whole[rows.ALIVE, fresh[gone]] = 0
