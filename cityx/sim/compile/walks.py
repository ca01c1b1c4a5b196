"""Walks of a world: rasters of where each traveller may be, crosswalks, and routes door to door."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.mesh import NO_VERTEX
from cityx.errors import InputError
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, arc_lengths
from cityx.ground.walking.walkable import CELL, Walkable, clearance_of, walkable_of
from cityx.ground.walking.walks import walk_graph, walks_between
from cityx.motion.people_trips import SMALLEST, ports_of
from cityx.sim.compile.signals import Crossed, crossing_signals
from cityx.sim.compile.tops import tops_of
from cityx.sim.kernels import rasters as kernels
from cityx.sim.travellers import TRAVELLER, TRAVELLERS
from cityx.sim.walks import AREA, FITS, ROUTED, VERGE, VERSION, Walks
from cityx.sim.world import World

HEAD, FOOT = 1.8, 0.12  # metres above the ground between which a thing is in one's way
NOON = 12.0  # hour whose doors count
GOALS, ORIGINS = 64, 12  # ends of routes, and routes to each
NEAREST, FARTHEST, FELT = 25.0, 150.0, 360.0  # metres between ends, and of way as walkers feel it
SHORTEST = 20.0  # metres of a route
NEAR = 3.2  # metres of clearance that travellers ask for at most
SQUARE = 12.0  # metres; places that routes join too where a city has few doors


def compile_walks(city: City, world: World) -> Walks:
    """Compile the walks of a city whose world is compiled.

    Raises
    ------
    InputError
        If nobody can walk in it, or it is too large to.
    """
    try:
        walkable = walkable_of(city)
    except ValueError as error:
        raise InputError(f'Nobody can walk in the city "{city.name}": {error}.') from error
    if not walkable.free.any():
        raise InputError(
            f'Nobody can walk in the city "{city.name}": it has no walk, path, plaza or land '
            "beside a street."
        )
    frame = np.array([walkable.grid.west, walkable.grid.extent[1], CELL, walkable.free.shape[1],
                      walkable.free.shape[0]])  # fmt: skip
    height = _heights(city, frame)
    area = walkable.grid.numbered(walkable.areas) > 0
    fits = _fits(walkable, area, world, height, frame)
    crossed = _crossed(walkable, fits)
    routes = _routes(city, walkable, fits, height, frame)
    flags = np.zeros(height.shape, np.uint8)
    for bit, own in ((AREA, area), (VERGE, walkable.verge), *zip(FITS, fits, strict=True)):
        flags[own[::-1]] |= np.uint8(bit)
    about = {"name": city.name, "hash": world.hash, "version": VERSION, "doors": routes.doors,
             "open_m2": [_largest(own) for own in fits]}  # fmt: skip
    crosswalks = walkable.crosswalks
    signal = crossing_signals(
        Crossed(world.point_start, world.point, world.piece_signal, world.across,
                world.next_start, world.next), crosswalks.ends,
    )  # fmt: skip
    return Walks(
        frame, flags, height, np.ascontiguousarray(walkable.crosswalk[::-1]), crosswalks.id,
        crosswalks.ends, signal, crossed, routes.start, routes.point, routes.crossing,
        routes.kind, routes.door, *tops_of(city), np.array([json.dumps(about)]),
    )  # fmt: skip


def _heights(city: City, frame: FloatArray) -> NDArray[np.float32]:
    """(h, w) metres of the tops of the ground, row 0 in the south; NaN where there is none."""
    height = np.full((int(frame[4]), int(frame[3])), np.nan, np.float32)
    ground = city.scene.meshes.get("ground")
    if ground is not None:
        tops = np.asarray(ground.faces[ground.faces[:, 3] == NO_VERTEX, :3])
        kernels.draw_tops(height, np.empty((0, 0), np.int32), frame, np.asarray(ground.vertices),
                          tops, np.empty(0, np.int64))  # fmt: skip
    return height


def _fits(
    walkable: Walkable, area: BoolArray, world: World, height: NDArray[np.float32],
    frame: FloatArray,
) -> list[BoolArray]:  # fmt: skip
    """Rasters, row 0 in the north, of where the middle of each traveller may be."""
    inner = _room(area, walkable.free)
    solid = np.zeros(height.shape, bool)
    segment = world.segment
    middle = (segment[:, :2] + segment[:, 2:4]) / 2
    column = np.clip((middle[:, 0] - frame[0]) // CELL, 0, frame[3] - 1).astype(np.int64)
    row = np.clip((middle[:, 1] - frame[1]) // CELL, 0, frame[4] - 1).astype(np.int64)
    foot = height[row, column]
    over = (segment[:, 5] > foot + FOOT) & (segment[:, 4] < foot + HEAD) | np.isnan(foot)
    kernels.draw_segments(solid, frame, np.asarray(segment[over]), 0, 0)
    room = _room(~solid[::-1], walkable.free)
    found = []
    for one in TRAVELLERS:
        steep = kernels.steps_over(height, one.step)[::-1]
        free = walkable.free & (room > one.radius + CELL)
        if one.wheels:
            # Wheels stay on the area and off every step, however it turns.
            reach = one.wheels * np.sqrt(2.0) + CELL / 2
            free &= inner > reach + CELL / 2
            free &= _room(~steep, free) > reach
            free &= ~walkable.verge
        else:
            free &= ~steep
        found.append(free)
    return found


def _room(free: BoolArray, wanted: BoolArray) -> NDArray[np.float32]:
    """(h, w) metres from wanted cells to the next that is not free, `NEAR` at most; 0 elsewhere."""
    return clearance_of(free, wanted, NEAR).astype(np.float32)


def _crossed(walkable: Walkable, fits: list[BoolArray]) -> BoolArray:
    """(c, t) whether each traveller gets from one end of crosswalks to the other on them."""
    from scipy.ndimage import label

    count = walkable.crosswalks.count
    found = np.zeros((count, len(fits)), bool)
    if not count:
        return found
    number = walkable.rim.astype(np.int64)
    over = walkable.crosswalk.astype(np.int64)
    for kind, free in enumerate(fits):
        piece = label(free & (number > 0), np.ones((3, 3)))[0]
        # A piece of it that reaches the walks on both sides leads across.
        row, column = np.nonzero((piece > 0) & (over == 0))
        spot = walkable.places(np.column_stack([row, column]))
        own, part = number[row, column] - 1, piece[row, column]
        ends = walkable.crosswalks.ends[own]
        side = np.hypot(*(spot - ends[:, 0]).T) > np.hypot(*(spot - ends[:, 1]).T)
        first = set(zip(own[~side].tolist(), part[~side].tolist(), strict=True))
        second = set(zip(own[side].tolist(), part[side].tolist(), strict=True))
        for one, _ in first & second:
            found[one, kind] = True
    return found


def _largest(free: BoolArray) -> float:
    """Square metres of the largest piece of a raster."""
    from scipy.ndimage import label

    count = np.bincount(label(free, np.ones((3, 3)))[0].ravel())[1:]
    return float(count.max(initial=0)) * CELL * CELL


class _Routes:
    """Routes as they gather; a class for the columns that they share."""

    def __init__(self) -> None:
        self.lines: list[FloatArray] = []
        self.kinds: list[int] = []
        self.ends: list[tuple[int, int]] = []
        self.doors = 0

    def closed(self, walkable: Walkable, height: NDArray[np.float32], frame: FloatArray) -> _Routes:
        """Put them in order and look up heights and crosswalks."""
        size = [float(np.hypot(*np.diff(line, axis=0).T).sum()) for line in self.lines]
        order = np.lexsort((np.arange(len(size)), np.array(size), np.array(self.kinds)))
        lines = [self.lines[row] for row in order]
        self.start = np.cumsum([0] + [len(line) for line in lines]).astype(np.int64)
        xy = np.concatenate([np.zeros((0, 2)), *lines])
        column = np.clip((xy[:, 0] - frame[0]) // CELL, 0, frame[3] - 1).astype(np.int64)
        row = np.clip((xy[:, 1] - frame[1]) // CELL, 0, frame[4] - 1).astype(np.int64)
        along = arc_lengths(Polylines(xy, self.start))[0] if lines else np.zeros(0)
        self.point = np.column_stack([xy, height[row, column].astype(float), along])
        self.crossing = walkable.at(walkable.crosswalk, xy).astype(np.int16)
        self.kind = np.array(self.kinds, np.int32)[order]
        self.door = np.array(self.ends, np.uint64).reshape(-1, 2)[order]
        return self


def _routes(
    city: City, walkable: Walkable, fits: list[BoolArray], height: NDArray[np.float32],
    frame: FloatArray,
) -> _Routes:  # fmt: skip
    """Find ways between doors, stops and borders that a traveller fits along."""
    found = _Routes()
    for name in ROUTED:
        free = fits[TRAVELLER[name]]
        own = replace(walkable, free=free, clearance=clearance_of(free))
        if not free.any():
            continue
        ports = ports_of(city, own, NOON)
        found.doors = max(found.doors, len(ports.node))
        node, key = ports.node, ports.id
        if len(node) < GOALS:
            more = _spread(own)
            node = np.concatenate([node, more])
            key = np.concatenate([key, np.zeros(len(more), np.uint64)])
        origin, goal, ends = _pairs(own, node, key)
        lines, led = walks_between(own, origin, goal, FELT)
        length = arc_lengths(lines)[1] if lines.count else np.zeros(0)
        for row in np.flatnonzero(led & (length > SHORTEST)).tolist():
            found.lines.append(lines.points[lines.start[row] : lines.start[row + 1]])
            found.kinds.append(TRAVELLER[name])
            found.ends.append((int(ends[row, 0]), int(ends[row, 1])))
    return found.closed(walkable, height, frame)


def _spread(walkable: Walkable) -> IntArray:
    """Nodes of the walk graph, one in each square of `SQUARE` metres, of pieces worth a walk."""
    graph = walk_graph(walkable)
    large = np.flatnonzero(graph.size[graph.component] >= SMALLEST)
    tile = np.floor(graph.places[large] / SQUARE).astype(np.int64)
    first = np.unique(tile, axis=0, return_index=True)[1] if len(large) else large
    return np.asarray(large[np.sort(first)], np.int64)


def _pairs(
    walkable: Walkable, node: IntArray, key: NDArray[np.uint64]
) -> tuple[IntArray, IntArray, NDArray[np.uint64]]:
    """Origins, goals and ids of both of routes; places come in the order of their ids."""
    graph = walk_graph(walkable)
    goals = np.arange(min(GOALS, len(node)))
    origin: list[IntArray] = [np.zeros(0, np.int64)]
    goal: list[IntArray] = [np.zeros(0, np.int64)]
    for target in goals.tolist():
        away = np.hypot(*(graph.places[node] - graph.places[node[target]]).T)
        joined = graph.component[node] == graph.component[node[target]]
        near = np.flatnonzero((away > NEAREST) & (away < FARTHEST) & joined)
        step = max(len(near) // ORIGINS, 1)
        mine = near[::step][:ORIGINS]
        origin.append(mine)
        goal.append(np.full(len(mine), target))
    one, other = np.concatenate(origin), np.concatenate(goal)
    return node[one], node[other], np.column_stack([key[one], key[other]])
