"""Walks as kernels take them: what lies under a place, where a route leads, who may cross."""

from __future__ import annotations

from math import atan2, cos, floor, hypot, inf, sin
from typing import Any, NamedTuple

from cityx.geometry.compiled import borrowing
from cityx.sim import travellers
from cityx.sim.kernels.idm import COMFORT, shown
from cityx.sim.kernels.lines import wrapped
from cityx.sim.kernels.tables import (
    ALIVE,
    ALONG,
    ASIDE,
    GONE,
    HEADING,
    LENGTH,
    POINT,
    SPEED,
    TURNED,
    WAITED,
    WIDTH,
    X,
    Y,
    Z,
)

AREA, FITS = 1, 4  # bits of the flags: one may walk there; from here on one bit for each traveller
ROUTE, ONWARD = 0, 1  # columns of `Batch.path` of who is on foot: its route, and 1 forwards or 0
LOOKED = 16  # points of a route ahead among which the nearest is looked for; half as many behind
YELLOW = 3  # states of signals from which on vehicles may come
STANDING = 0.5  # m/s below which a vehicle lets people cross
PATIENCE = 5.0  # seconds after which one goes round a vehicle that stands on a crosswalk
HALF_DEPTH = 0.8  # metres beside the axis of a crosswalk that people need
STOREY = 3.0  # metres above a crosswalk from which on one drives, or flies, over it
NOTICED = 1.0  # seconds until a driver brakes for who steps out
CLEAR = 4.0  # metres beside a crosswalk from which a vehicle that stands is no danger


class Paths(NamedTuple):
    """Arrays of `cityx.sim.walks.Walks`; r routes, c crosswalks, t kinds of travellers."""

    frame: Any
    flags: Any
    height: Any
    crossing: Any
    signal: Any  # (c,) program, -1 for none
    need: Any  # (c,) seconds to get across
    ends: Any  # (c, 2, 2)
    start: Any
    point: Any  # (p, 4) x, y, z, metres from the start
    over: Any  # (p,) number of a crosswalk
    length: Any  # (r,) metres
    first: Any  # (t + 1,) first route of each kind
    travellers: Any  # (t, 8), `cityx.sim.travellers`
    top: Any  # (h, w) float32, metres of what is highest in cells of `top_frame`
    top_frame: Any


@borrowing
def cell_under(paths: Any, x: float, y: float) -> Any:
    """Return row and column of a place, -1 twice beyond the rasters."""
    frame = paths.frame
    i, j = floor((x - frame[0]) / frame[2]), floor((y - frame[1]) / frame[2])
    if i < 0 or j < 0 or i >= frame[3] or j >= frame[4]:
        return -1, -1
    return j, i


@borrowing
def height_at(paths: Any, x: float, y: float) -> Any:
    """Return metres of the ground under a place, minus infinity where there is none."""
    row, column = cell_under(paths, x, y)
    if row < 0:
        return -inf
    z = float(paths.height[row, column])
    return z if z == z else -inf


@borrowing
def flags_at(paths: Any, x: float, y: float) -> Any:
    """Return the bits of a place, 0 beyond the rasters."""
    row, column = cell_under(paths, x, y)
    return 0 if row < 0 else int(paths.flags[row, column])


@borrowing
def crossing_at(paths: Any, x: float, y: float) -> Any:
    """Return the number from 1 of the crosswalk on a roadway at a place, 0 for none."""
    row, column = cell_under(paths, x, y)
    return 0 if row < 0 else int(paths.crossing[row, column])


@borrowing
def light(world: Any, paths: Any, crossing: int, clock: float) -> Any:
    """Return what people see at a crosswalk: 1 stop, 0 go, -1 where there is no signal.

    They may go while whoever drives over it has to stop, and has to until they are across.
    """
    signal = paths.signal[crossing - 1]
    if signal < 0:
        return -1
    need = paths.need[crossing - 1]
    for k in range(3):
        if shown(world, signal, clock + need * k / 2) >= YELLOW:
            return 1
    return 0


@borrowing
def may_cross(world: Any, paths: Any, here: Any, first: int, feet: int, crossing: int) -> Any:
    """Return whether one may step onto a crosswalk: no red, and no vehicle that comes too soon.

    Where there is no signal drivers give way: who can still stop in comfort is not waited for. On a
    busy street no gap would ever come that is long enough to get across.

    Parameters
    ----------
    first, feet
        Rows of movers from which on they are on walks, and up to which; all others are vehicles.
    crossing
        Number from 1.
    """
    if light(world, paths, crossing, here.clock[0]) == 1:
        return False
    real = here.real
    ends, need = paths.ends[crossing - 1], paths.need[crossing - 1]
    mx, my = (ends[0, 0] + ends[1, 0]) / 2, (ends[0, 1] + ends[1, 1]) / 2
    half = hypot(ends[1, 0] - ends[0, 0], ends[1, 1] - ends[0, 1]) / 2
    ground = height_at(paths, mx, my)
    for m in range(real.shape[1]):
        if first <= m < feet or here.whole[ALIVE, m] == 0 or real[Z, m] - ground > STOREY:
            continue
        dx, dy = mx - real[X, m], my - real[Y, m]
        away = hypot(dx, dy) - half - real[LENGTH, m] / 2
        speed = real[SPEED, m]
        if away < CLEAR and speed > STANDING:
            return False
        if away < 0.5 and real[WAITED, m] < PATIENCE and stands_on(here, m, ends):
            return False
        angle = wrapped(atan2(dy, dx) - real[HEADING, m])
        comes = speed * (need + 1.0)
        if paths.signal[crossing - 1] < 0:
            comes = min(comes, speed * speed / (2 * COMFORT) + speed * NOTICED + CLEAR)
        if abs(angle) < 0.9 and speed > STANDING and away < comes:
            return False
    return True


@borrowing
def stands_on(here: Any, m: int, ends: Any) -> Any:
    """Return whether the body of a vehicle is over the axis of a crosswalk, or nearly so."""
    real = here.real
    ax, ay = ends[1, 0] - ends[0, 0], ends[1, 1] - ends[0, 1]
    size = max(hypot(ax, ay), 1e-6)
    dx, dy = real[X, m] - ends[0, 0], real[Y, m] - ends[0, 1]
    angle = real[HEADING, m] - atan2(ay, ax)
    long, wide = real[LENGTH, m] / 2, real[WIDTH, m] / 2
    c, s = abs(cos(angle)), abs(sin(angle))
    along, aside = (dx * ax + dy * ay) / size, abs(dx * ay - dy * ax) / size
    return aside < HALF_DEPTH + long * s + wide * c and (
        -long * c - wide * s < along < size + long * c + wide * s
    )


@borrowing
def on_path(paths: Any, here: Any, n: int, ahead: float) -> Any:
    """Return x, y and the crosswalk's number of a place so many metres ahead on a route."""
    route, onward = here.path[n, ROUTE], here.path[n, ONWARD]
    first, last = paths.start[route], paths.start[route + 1] - 1
    want = here.real[ALONG, n] + (ahead if onward else -ahead)
    k = here.whole[POINT, n]
    point = paths.point
    while k < last - 1 and point[k + 1, 3] < want:
        k += 1
    while k > first and point[k, 3] > want:
        k -= 1
    run = point[k + 1, 3] - point[k, 3]
    t = min(max((want - point[k, 3]) / run if run > 1e-9 else 0.0, 0.0), 1.0)
    over = paths.over[k + 1] if t > 0.5 else paths.over[k]
    return (point[k, 0] + t * (point[k + 1, 0] - point[k, 0]),
            point[k, 1] + t * (point[k + 1, 1] - point[k, 1]), over)  # fmt: skip


@borrowing
def follow_path(paths: Any, here: Any, n: int) -> None:
    """Find where on its route a mover on foot is; write metres along, aside and gone."""
    real, whole = here.real, here.whole
    route, onward = here.path[n, ROUTE], here.path[n, ONWARD]
    first, last = paths.start[route], paths.start[route + 1] - 1
    at, point = whole[POINT, n], paths.point
    ahead, behind = (LOOKED, LOOKED // 2) if onward else (LOOKED // 2, LOOKED)
    x, y = real[X, n], real[Y, n]
    best, nearest, along, aside, angle = inf, at, real[ALONG, n], 0.0, 0.0
    for k in range(max(at - behind, first), min(at + ahead, last - 1) + 1):
        ax, ay = point[k, 0], point[k, 1]
        dx, dy = point[k + 1, 0] - ax, point[k + 1, 1] - ay
        run = dx * dx + dy * dy
        t = min(max(((x - ax) * dx + (y - ay) * dy) / run if run > 1e-12 else 0.0, 0.0), 1.0)
        ox, oy = x - ax - t * dx, y - ay - t * dy
        away = ox * ox + oy * oy
        if away < best:
            best, nearest = away, k
            size = hypot(dx, dy)
            along = point[k, 3] + t * (point[k + 1, 3] - point[k, 3])
            aside = (dx * (y - ay) - dy * (x - ax)) / max(size, 1e-9)
            angle = atan2(dy, dx)
    if not onward:
        aside, angle = -aside, angle + 3.141592653589793
    whole[POINT, n] = nearest
    real[ALONG, n], real[ASIDE, n] = along, aside
    real[TURNED, n] = wrapped(real[HEADING, n] - angle)
    real[GONE, n] = along if onward else paths.length[route] - along


@borrowing
def crossing_ahead(paths: Any, here: Any, n: int, sight: float, step: float) -> Any:
    """Return metres to the next crosswalk on a route and its number; `sight` and 0 for none.

    One that the mover is on already does not count.
    """
    on = crossing_at(paths, here.real[X, n], here.real[Y, n])
    left = False
    away = 0.0
    while away < sight:
        away += step
        _, _, over = on_path(paths, here, n, away)
        if over != on:
            left = True
        if over > 0 and (over != on or (left and on == 0)):
            return away, over
    return sight, 0


@borrowing
def fits_at(paths: Any, x: float, y: float, kind: int) -> Any:
    """Return whether the middle of a kind of traveller may be at a place."""
    return flags_at(paths, x, y) & (FITS << kind) != 0


@borrowing
def radius_of(paths: Any, kind: int) -> Any:
    """Return metres about the middle of a kind of traveller that it takes up."""
    own = paths.travellers[kind]
    if own[travellers.WHEELS] > 0.0:
        return hypot(own[travellers.LENGTH], own[travellers.WIDTH]) / 2
    return own[travellers.LENGTH] / 2
