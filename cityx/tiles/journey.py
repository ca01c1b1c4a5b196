"""Journeys: one drive over many tiles, of which only those about the vehicle are loaded.

The way is known from the lanes of all tiles between its ends, as metres to go from each. What is
driven in is the world of a tile and its neighbours. In the next tile the world of that and its
neighbours takes over: vehicle, clock and the traffic that is in both worlds go on as they are.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.lanes import MOVEMENTS, LaneGraph
from cityx.city.section import KIND as KINDS
from cityx.errors import InputError, UsageError
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import arc_lengths, to_linestrings
from cityx.ids import hash_bits
from cityx.sim.baseline import end_of
from cityx.sim.engine import Engine
from cityx.sim.kernels import tables as rows
from cityx.sim.kernels.traffic import STUCK, UNSEEN
from cityx.sim.options import DriveOptions
from cityx.sim.state import DT, LONGEST
from cityx.sim.world import World
from cityx.tiles.grid import Tile, tile_at
from cityx.tiles.joining import region_world
from cityx.tiles.order import read_order
from cityx.tiles.region import region_about, region_streets

CORRIDOR = 400  # tiles between the ends of a journey whose lanes are looked at, at most
BESIDE = 1000.0  # metres beside the straight line between the ends that the way may take
NEAREST = 150.0  # metres from a place to the lane that stands for it
SOME = 8  # lanes near a place that are tried, for the next may lead the wrong way
RIM = 6.0  # metres from the border of what is loaded at which a lane leads out of it
FREE, FAR = 14.0, 60.0  # metres from others, and from the vehicle, at which traffic comes anew
WITHIN = 60.0  # metres from that border at which a world has every turn that there is
LEFT = 0.5  # metres of a way that are not driven
STARTS = 6.0  # metres of its first lane that a vehicle has behind it
STANDS, STUCK_S = 0.1, 300.0  # m/s, and seconds at less of them after which a journey is given up
LOCKED_S = 90.0  # seconds of standing after which traffic about it that stands too makes way
MOST_S = 7200.0  # seconds that a journey takes

EMPTY: Mapping[int, Collection[int]] = MappingProxyType({})


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
        (n, 4) float64: seconds, x, y in metres of the frame of the run, m/s, at each step.
    tiles
        Those that were driven through, in order.
    """

    end: str
    metres: float
    to_go: float
    track: FloatArray
    tiles: tuple[str, ...]

    @property
    def digest(self) -> str:
        """32 hexadecimal digits over every bit of the track."""
        return blake2b(np.ascontiguousarray(self.track).tobytes(), digest_size=16).hexdigest()


def metres_to(
    lanes: LaneGraph, goal: int, turns: Mapping[int, Collection[int]] = EMPTY
) -> dict[int, float]:
    """Return the metres from the start of lanes that lead to one to the start of that, by id.

    Parameters
    ----------
    lanes
        Of all tiles between.
    goal
        Id of a lane.
    turns
        Ids of lanes of which more is known, and of all lanes that each leads to.
    """
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import dijkstra

    length = arc_lengths(lanes.lines)[1]
    pairs = lanes.connection[lanes.movement != MOVEMENTS.index("reverse")]
    if turns:
        numbers = {key: row for row, key in enumerate(lanes.lane_id.tolist())}
        told = np.array([key in turns for key in numbers])
        known = [(numbers[key], numbers[onto]) for key, onward in turns.items() if key in numbers
                 for onto in sorted(onward) if onto in numbers]  # fmt: skip
        pairs = np.concatenate([pairs[~told[pairs[:, 0]]], np.array(known, int).reshape(-1, 2)])
    source, target = pairs.T
    across = np.hypot(*(lanes.points[lanes.point_start[target]]
                        - lanes.points[lanes.point_start[source + 1] - 1]).T)  # fmt: skip
    cost = np.maximum(length[source] + across, 1e-3)
    first = np.unique(np.column_stack([source, target]), axis=0, return_index=True)[1]
    graph = csr_matrix((cost[first], (target[first], source[first])), (lanes.count, lanes.count))
    row = int(np.flatnonzero(lanes.lane_id == np.uint64(goal))[0])
    found = dijkstra(graph, indices=row)
    known = np.isfinite(found)
    return dict(zip(lanes.lane_id[known].tolist(), found[known].tolist(), strict=True))


def journey(
    folder: Path, start: tuple[float, float], goal: tuple[float, float], *,
    options: DriveOptions | None = None, seed: int = 0,
    say: Callable[[str], None] = lambda _: None,
) -> Trip:  # fmt: skip
    """Drive from a place to another by rule; tiles that are missing are built on the way.

    Parameters
    ----------
    folder
        Of tiles of a map.
    start, goal
        Metres of the frame of the run.
    options
        Of the drive; what they say of routes and of the horizon does not count.
    seed
        Of the traffic.

    Raises
    ------
    InputError, UsageError
        If there is no lane at an end, or no way.
    """
    options = options or DriveOptions()
    order, _ = read_order(folder)
    if order.plane is not None:
        raise UsageError("Journeys are made on the tiles of a map.")
    streets = _corridor(folder, start, goal)
    begin, ends, to_go = _ends(streets, start, goal)
    say(f"{to_go[begin]:,.0f} m to go")
    drive = _Drive(folder, order.size, options, seed, streets, to_go, ends, goal, say)
    return drive.run(start, begin)


def _corridor(folder: Path, start: tuple[float, float], goal: tuple[float, float]) -> LaneGraph:
    low, high = np.minimum(start, goal) - BESIDE, np.maximum(start, goal) + BESIDE
    (x, y), (wide, deep) = ((low + high) / 2).tolist(), (high - low).tolist()
    city = region_streets(region_about(folder, (x, y), (wide, deep), most=CORRIDOR))
    if city.lanes is None or not city.lanes.count:
        raise InputError("The tiles between the places have no streets.")
    return city.lanes


def _ends(
    lanes: LaneGraph, start: tuple[float, float], goal: tuple[float, float]
) -> tuple[int, list[int], dict[int, float]]:
    """Return the lane nearest to a place that leads to another, lanes there, metres to the first.

    The others are for a vehicle that does not fit where the first lies.
    """
    begins, goals = (_near(lanes, place) for place in (start, goal))
    for number, end in enumerate(goals):
        to_go = metres_to(lanes, end)
        for begin in begins:
            if begin in to_go and begin != end:
                return begin, goals[number:], to_go
    raise InputError("No way leads from the one place to the other over the tiles between.")


def _near(lanes: LaneGraph, place: tuple[float, float]) -> list[int]:
    """Return the ids of the lanes for cars that are nearest to a place, at most `SOME`."""
    driven = np.flatnonzero((lanes.kind == KINDS["drive"]) & (lanes.direction != 0))
    away = shapely.distance(to_linestrings(lanes.lines)[driven], shapely.Point(place))
    order = np.lexsort((lanes.lane_id[driven], away))[:SOME]
    order = order[away[order] <= NEAREST]
    if not len(order):
        raise InputError(
            f"No lane for cars lies within {NEAREST:g} m of {place[0]:.0f},{place[1]:.0f}."
        )
    found: list[int] = lanes.lane_id[driven[order]].tolist()
    return found


class _Drive:
    """A journey while it lasts; a class for the engine that takes over from the one before."""

    def __init__(
        self, folder: Path, size: float, options: DriveOptions, seed: int,
        streets: LaneGraph, to_go: dict[int, float], goals: list[int],
        place: tuple[float, float],
        say: Callable[[str], None],
    ) -> None:  # fmt: skip
        self._folder, self._size, self._seed, self._say = folder, size, seed, say
        horizon = int(MOST_S / DT)
        self._options = DriveOptions(**{**vars(options), "horizon": horizon, "agents": 1})
        self._to_go, self._goal, self._others, self._place = to_go, goals[0], goals[1:], place
        self._streets = streets
        self._turns: dict[int, set[int]] = {}  # of lanes that were loaded: where they lead
        self._box = (0.0, 0.0, 0.0, 0.0)  # of what is loaded
        self._last = False  # whether the way of the engine ends at the goal

    def run(self, start: tuple[float, float], lane: int) -> Trip:
        tile, far = tile_at(*start, self._size), self._to_go[lane]
        engine = self._engine(tile)
        if not self._set_out(engine, lane):
            return Trip("no way", 0.0, far, np.zeros((0, 4)), (tile.name,))
        track: list[tuple[float, ...]] = []
        tiles, end, moved = [tile], "late", 0
        while len(track) * DT < MOST_S:
            engine.step(engine.act_by_rule(), anew=False)
            x, y, speed = engine.state.real[0, [rows.X, rows.Y, rows.SPEED], 0].tolist()
            track.append((round(len(track) * DT, 6), x, y, speed))
            moved = len(track) if speed > STANDS else moved
            if (len(track) - moved) * DT > LOCKED_S:
                _unlock(engine)
            if (len(track) - moved) * DT > STUCK_S:
                end = "stuck"
                break
            bits, here = int(engine.out.event[0, 0]), tile_at(x, y, self._size)
            arrived = bool(bits & rows.GOAL_REACHED)
            if engine.out.ended[0, 0] and (self._last or not arrived):
                end = end_of(engine, bits)
                break
            if arrived or here != tiles[-1]:
                if here == tiles[-1]:
                    end = "no way"  # the way ends in the middle of what is loaded
                    break
                tiles.append(here)
                after = self._taken_over(engine, here)
                if after is None:
                    end = "no way"
                    break
                engine = after
        way = np.array(track).reshape(-1, 4)
        metres = float(np.hypot(*np.diff(way[:, 1:3], axis=0).T).sum())
        return Trip(end, metres, far, way, tuple(each.name for each in tiles))

    def _engine(self, tile: Tile) -> Engine:
        west, south, east, north = tile.box(self._size)
        middle = ((west + east) / 2, (south + north) / 2)
        region = region_about(self._folder, middle, (2 * self._size, 2 * self._size))
        self._box = region.box
        self._say(f"in {tile.name}, {len(region.tiles)} tiles loaded")
        engine = Engine(region_world(region), self._options)
        engine.seed(hash_bits(self._seed, "journey", tile.column, tile.row))
        engine.begin()
        return engine

    def _set_out(self, engine: Engine, lane: int) -> bool:
        """Put the vehicle on a lane with its way before it."""
        world = engine.world
        piece = _rows_by_key(world).get((lane, 0))
        kind = int(engine.state.whole[0, rows.KIND, 0])
        self._learn(engine, kind)
        path = None if piece is None else self._way(engine, piece, kind)
        if piece is None or path is None:
            return False
        real, first = engine.state.real[0], int(world.point_start[piece])
        points = world.point[first : world.point_start[piece + 1]]
        at = int(np.searchsorted(points[:, 4], min(STARTS, points[-1, 4] / 2)))
        real[[rows.X, rows.Y, rows.Z, rows.HEADING, rows.ALONG, rows.LIFT], 0] = points[at]
        for row in (rows.SPEED, rows.STEER, rows.ASIDE, rows.TURNED):
            real[row, 0] = 0.0
        _lead(engine, 0, path, at)
        self._end_way(engine, path)
        _clear(engine, 1)
        return True

    def _taken_over(self, before: Engine, tile: Tile) -> Engine | None:
        """Return an engine about another tile in which everything goes on; None if no way does."""
        engine = self._engine(tile)
        known = _rows_by_key(engine.world)
        was, state = before.state, engine.state
        state.clock[0] = was.clock[0]
        mover = 0
        for n in range(was.real.shape[2]):
            if not was.whole[0, rows.ALIVE, n] or mover == state.real.shape[2]:
                continue
            path = _carried(before, n, known)
            if n == 0:
                kind = int(was.whole[0, rows.KIND, 0])
                self._learn(engine, kind)
                path = (self._way(engine, path[0], kind) if path else None) or []
                if not path:
                    return None
            if not path:
                continue
            piece = int(was.path[0, n, was.whole[0, rows.AT, n]])
            at = int(was.whole[0, rows.POINT, n] - before.world.point_start[piece])
            state.real[0, :, mover] = was.real[0, :, n]
            for row in (rows.KIND, rows.ALIVE):
                state.whole[0, row, mover] = was.whole[0, row, n]
            _lead(engine, mover, path, at)
            for row in (rows.BEFORE, rows.CLEARED):
                there = _row_in(before.world, int(was.whole[0, row, n]), known)
                state.whole[0, row, mover] = -1 if there is None else there
            mover += 1
        self._end_way(engine, state.path[0, 0, : state.whole[0, rows.SIZE, 0]].tolist())
        _clear(engine, mover)
        before.close()
        return engine

    def _learn(self, engine: Engine, kind: int) -> None:
        """Keep where lanes lead for a kind of vehicle, as a world shows it.

        A world knows where it does not fit, which lanes do not say. What is loaded later would
        lead back there, and be found closed again.
        """
        world, lanes = engine.world, self._streets
        usable = engine.map.usable[:, kind] > 0
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

    def _way(self, engine: Engine, piece: int, kind: int) -> list[int] | None:
        """Return the pieces from one on to the goal, or to where least is left; None if none.

        Where none leads to the lane nearest to the place the next one there is gone to.
        """
        while (path := self._way_to(engine, piece, kind)) is None and self._others:
            self._goal = self._others.pop(0)
            self._to_go = metres_to(self._streets, self._goal, self._turns)
        return path

    def _way_to(self, engine: Engine, piece: int, kind: int) -> list[int] | None:
        from scipy.sparse import csr_matrix
        from scipy.sparse.csgraph import dijkstra

        world = engine.world
        usable = engine.map.usable[:, kind] > 0
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
        self._last = int(world.piece_lane[best]) == self._goal and len(path) <= LONGEST
        return path[::-1][:LONGEST]

    def _end_way(self, engine: Engine, path: list[int]) -> None:
        """Say how far the vehicle is led."""
        real = engine.state.real[0]
        length = float(engine.world.piece_length[path].sum())
        if self._last:
            first, end = engine.world.point_start[[path[-1], path[-1] + 1]].tolist()
            lane = engine.world.point[first:end]
            near = np.argmin(np.hypot(*(lane[:, :2] - self._place).T))
            length -= float(lane[-1, 4] - lane[near, 4])
        real[rows.GOAL, 0] = max(length - real[rows.ALONG, 0] - LEFT, LEFT)
        real[rows.GONE, 0] = 0.0
        engine.state.whole[0, rows.STEPS, 0] = 0


def _rows_by_key(world: World) -> dict[tuple[int, int], int]:
    """Return the pieces of a world by their lane, and the lane that ways across lead into."""
    keys = zip(world.piece_lane.tolist(), world.piece_onto.tolist(), strict=True)
    return {key: row for row, key in enumerate(keys)}


def _row_in(world: World, piece: int, known: dict[tuple[int, int], int]) -> int | None:
    """Return the row of a piece in another world, None where that does not have it."""
    if piece < 0:
        return None
    return known.get((int(world.piece_lane[piece]), int(world.piece_onto[piece])))


def _carried(engine: Engine, n: int, known: dict[tuple[int, int], int]) -> list[int]:
    """Return the way of a mover from its piece on in another world, as far as that has it."""
    whole, world = engine.state.whole[0], engine.world
    ahead: Any = engine.state.path[0, n, whole[rows.AT, n] : whole[rows.SIZE, n]].tolist()
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
    whole[rows.STEPS, mover] = 0 if mover == 0 else -1


def _unlock(engine: Engine) -> None:
    """Let traffic that has stood long go elsewhere, though it is seen.

    Out of sight it does so by itself. Where vehicles wait for each other round a junction and the
    journey stands among them, none of them is out of sight. Where that does not help, since others
    come and wait in their stead, all that stand go.
    """
    real, whole = engine.state.real[0], engine.state.whole[0]
    away = np.hypot(real[rows.X] - real[rows.X, 0], real[rows.Y] - real[rows.Y, 0])
    least = STUCK if real[rows.WAITED, 0] < 2 * LOCKED_S else 0.0
    gone = (away < UNSEEN) & (real[rows.WAITED] > least) & (whole[rows.ALIVE] > 0)
    gone[0] = False
    whole[rows.ALIVE, gone] = 0
    real[rows.WAITED, gone] = 0.0


def _clear(engine: Engine, carried: int) -> None:
    """Take the traffic that was drawn anew out of the way of what was there."""
    real, whole = engine.state.real[0], engine.state.whole[0]
    place: NDArray[np.float64] = real[[rows.X, rows.Y]].T
    fresh: IntArray = np.arange(carried, len(place))
    apart = np.hypot(*(place[fresh, None] - place[None, :carried]).transpose(2, 0, 1))
    gone = (apart < FREE).any(axis=1) | (apart[:, 0] < FAR)
    whole[rows.ALIVE, fresh[gone]] = 0
