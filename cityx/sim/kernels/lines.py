"""Places on the lines of pieces, and how far along its route a mover is."""

from __future__ import annotations

from math import cos, pi, sin
from typing import Any

from cityx.geometry.compiled import borrowing
from cityx.sim.kernels.tables import (
    ALONG,
    ASIDE,
    AT,
    BEFORE,
    GONE,
    HEADING,
    LIFT,
    LIMIT,
    PIECE,
    POINT,
    SIZE,
    TURNED,
    X,
    Y,
    Z,
)

PX, PY, PZ, PHEADING, PALONG, PLIFT = range(6)  # columns of points
AHEAD, BEHIND = 8, 3  # points of a route among which the nearest one is looked for


@borrowing
def pose(world: Any, piece: int, along: float, near: int) -> Any:
    """Return x, y, z, heading, lift and the point before it of a place on a piece.

    Parameters
    ----------
    piece, along
        The piece and metres from its start.
    near
        A point of the piece from which on the place is looked for; behind it all are searched.
    """
    point = world.point
    first, last = world.point_start[piece], world.point_start[piece + 1] - 1
    k = min(max(near, first), last - 1)
    if point[k, PALONG] > along:
        k = first
    while k < last - 1 and point[k + 1, PALONG] < along:
        k += 1
    run = point[k + 1, PALONG] - point[k, PALONG]
    t = (along - point[k, PALONG]) / run if run > 1e-9 else 0.0
    t = min(max(t, 0.0), 1.0)
    return (
        point[k, PX] + t * (point[k + 1, PX] - point[k, PX]),
        point[k, PY] + t * (point[k + 1, PY] - point[k, PY]),
        point[k, PZ] + t * (point[k + 1, PZ] - point[k, PZ]),
        point[k, PHEADING] + t * (point[k + 1, PHEADING] - point[k, PHEADING]),
        point[k, PLIFT] + t * (point[k + 1, PLIFT] - point[k, PLIFT]),
        k,
    )


@borrowing
def on_route(world: Any, here: Any, n: int, along: float, at: int, near: int) -> Any:
    """Return where a place ahead on a route is; beyond the end of the route that end.

    Parameters
    ----------
    along, at, near
        Metres from the start of the piece that is the `at`-th of the route, and a point of it.

    Returns
    -------
    place, along, at
        Pose, and metres along the piece that it is on, which may be beyond the end of the last.
    """
    size = here.whole[SIZE, n]
    piece = here.path[n, at]
    while along > world.length[piece] and at + 1 < size:
        along -= world.length[piece]
        at += 1
        piece = here.path[n, at]
        near = world.point_start[piece]
    return pose(world, piece, min(along, world.length[piece]), near), along, at


@borrowing
def wrapped(angle: float) -> Any:
    """Return an angle between -pi and pi."""
    return (angle + pi) % (2 * pi) - pi


@borrowing
def follow(world: Any, here: Any, n: int) -> Any:
    """Find where on its route an agent is, and set what follows from it.

    Returns
    -------
    crossed
        The way across a junction that it came onto, -1 for none.
    """
    real, whole, path = here.real, here.whole, here.path
    point = world.point
    x, y = real[X, n], real[Y, n]
    at, k = whole[AT, n], whole[POINT, n]
    size = whole[SIZE, n]
    piece = path[n, at]
    best = 1e18
    place, there = at, k
    # Back along the piece, then ahead over the ends of pieces.
    low = max(world.point_start[piece], k - BEHIND)
    j, row, count = at, low, AHEAD + k - low
    for _ in range(count + 1):
        last = world.point_start[path[n, j] + 1] - 1
        if row >= last:
            if j + 1 >= size:
                break
            j += 1
            row = world.point_start[path[n, j]]
            last = world.point_start[path[n, j] + 1] - 1
        dx, dy = point[row + 1, PX] - point[row, PX], point[row + 1, PY] - point[row, PY]
        square = dx * dx + dy * dy
        t = ((x - point[row, PX]) * dx + (y - point[row, PY]) * dy) / square if square > 0 else 0.0
        t = min(max(t, 0.0), 1.0)
        ox, oy = x - point[row, PX] - t * dx, y - point[row, PY] - t * dy
        away = ox * ox + oy * oy
        if away < best:
            best, place, there = away, j, row
        row += 1
    crossed = -1
    for j in range(at + 1, place + 1):
        if world.across[path[n, j]]:
            crossed = path[n, j]
    gone = real[GONE, n] - real[ALONG, n]  # metres up to the start of the piece
    for j in range(at, place):
        gone += world.length[path[n, j]]
        whole[BEFORE, n] = path[n, j]
    piece = path[n, place]
    dx, dy = point[there + 1, PX] - point[there, PX], point[there + 1, PY] - point[there, PY]
    square = dx * dx + dy * dy
    t = ((x - point[there, PX]) * dx + (y - point[there, PY]) * dy) / square if square > 0 else 0.0
    t = min(max(t, 0.0), 1.0)
    heading = point[there, PHEADING] + t * (point[there + 1, PHEADING] - point[there, PHEADING])
    whole[AT, n], whole[POINT, n], whole[PIECE, n] = place, there, piece
    along = point[there, PALONG] + t * (point[there + 1, PALONG] - point[there, PALONG])
    real[ALONG, n] = along
    real[GONE, n] = gone + along
    real[Z, n] = point[there, PZ] + t * (point[there + 1, PZ] - point[there, PZ])
    real[LIFT, n] = point[there, PLIFT] + t * (point[there + 1, PLIFT] - point[there, PLIFT])
    ox, oy = x - point[there, PX] - t * dx, y - point[there, PY] - t * dy
    real[ASIDE, n] = oy * cos(heading) - ox * sin(heading)
    real[TURNED, n] = wrapped(real[HEADING, n] - heading)
    real[LIMIT, n] = world.speed[piece]
    return crossed
