"""Changes of lanes: whether the lane beside is better and free, and the way over to it.

References
----------
Kesting, Treiber and Helbing, "General lane-changing model MOBIL for car-following models",
Transportation Research Record 1999, 2007 (what is gained, what it costs who is behind, and when it
is safe).
"""

from __future__ import annotations

from math import cos, sin
from typing import Any

from cityx.geometry.compiled import borrowing
from cityx.sim import dynamics
from cityx.sim.kernels.idm import GAP, held_back, neighbours, on_lane
from cityx.sim.kernels.lines import pose
from cityx.sim.kernels.spawn import look_ahead
from cityx.sim.kernels.tables import (
    ALONG,
    ASIDE,
    AT,
    CLEARED,
    KIND,
    LEAVES,
    LENGTH,
    LIMIT,
    PIECE,
    POINT,
    SIZE,
    SPEED,
    TURNED,
    X,
    Y,
)

GAIN, POLITE = 0.6, 0.3  # m/s2 that a change must bring, and share of what it costs who is behind
SAFE = 2.0  # m/s2 that who is behind may have to brake
ROOM = 2.5  # metres to bodies ahead and behind on the other lane at least
HINDERED, SLOWER = 45.0, 1.5  # metres ahead within which somebody so many m/s slower hinders
STEEPEST, SIDEWAYS = 0.25, 1.2  # metres aside for each ahead, and m/s aside, at most
EASE, TURN = 0.3, 0.1  # of metres aside that are left, and of the slope in each metre
OUT = 0.9  # metres beside a lane from which on a vehicle is in nobody's way on the other
OVER = 12.0  # metres that the end of a change takes
SWING = 9.0  # metres to what stands ahead from which on one gets round it
STANDING = 2.0  # m/s below which somebody ahead is passed by who drives by rule
SIGHT, RETURN = 30.0, 22.0  # metres ahead that it looks, and of lane that it needs to come back
BEYOND = 12.0  # metres of free lane ahead of what it passes


@borrowing
def steepest(speed: float) -> Any:
    """Return how many metres aside a vehicle goes for each ahead, at most."""
    return min(STEEPEST, SIDEWAYS / max(speed, 0.1))


@borrowing
def slope_towards(aside: float, slope: float, speed: float, metres: float) -> Any:
    """Return the slope with which a vehicle goes on to the line that it is aside of."""
    most = steepest(speed)
    wanted = min(max(-EASE * aside, -most), most)
    return slope + min(max(wanted - slope, -TURN * metres), TURN * metres)


@borrowing
def abreast(world: Any, here: Any, n: int, lane: int) -> Any:
    """Return metres along a lane that are beside a mover, and metres that it is left of its line.

    The mover is on, or has a route along, the piece that lane is beside.
    """
    real, whole = here.real, here.whole
    piece = here.path[n, whole[AT, n]]
    along = real[ALONG, n] * world.length[lane] / max(world.length[piece], 1e-6)
    aside, point = 0.0, world.point_start[lane]
    for _ in range(3):
        x, y, _, heading, _, point = pose(world, lane, along, point)
        c, s = cos(heading), sin(heading)
        dx, dy = real[X, n] - x, real[Y, n] - y
        along = min(max(along + dx * c + dy * s, 0.0), world.length[lane])
        aside = dy * c - dx * s
    return along, aside


@borrowing
def better_lane(
    world: Any, here: Any, n: int, gap: float, ahead: float, near: Any, count: int
) -> Any:
    """Return the lane that a vehicle of the traffic changes to, -1 to stay.

    It changes where its own lane leads nowhere, or where somebody ahead hinders it and it gains by
    more than what who is behind it there loses; never where that one would have to brake hard, nor
    so near to the end of the lane that the change were not over.

    Parameters
    ----------
    gap, ahead
        Metres to the body ahead, and its m/s.
    near, count
        Rows of those in sight, and how many.
    """
    real, whole = here.real, here.whole
    piece, kind, speed = here.path[n, 0], whole[KIND, n], real[SPEED, n]
    if whole[LEAVES, n] >= 0 or whole[CLEARED, n] >= 0 or real[ASIDE, n] != 0.0:
        return -1
    if real[ALONG, n] < real[LENGTH, n] / 2 + 1.0:
        return -1
    ends = whole[SIZE, n] < 2
    hindered = gap < HINDERED and ahead < min(real[LIMIT, n], world.speed[piece]) - SLOWER
    hindered = hindered and (gap > SWING or ahead > STANDING)
    if not ends and not hindered:
        return -1
    most = world.vehicles[kind, dynamics.ACCEL]
    stays = held_back(speed, ahead, gap, most, GAP)
    best, gain = -1, GAIN
    for side in range(2):
        lane = world.beside[piece, side]
        if lane < 0 or world.usable[lane, kind] < 2:
            continue
        has_to = ends and world.next_start[lane] < world.next_start[lane + 1]
        if not has_to and not hindered:
            continue
        along, aside = abreast(world, here, n, lane)
        if world.length[lane] - along < abs(aside) / steepest(speed) + OVER:
            continue
        free, its, back, behind = on_lane(world, here, n, lane, along, near, count)
        if free < ROOM or back < ROOM:
            continue
        follows = held_back(behind, speed, back, most, GAP)
        if follows < -SAFE:
            continue
        goes = held_back(speed, its, free, most, GAP)
        if goes < -SAFE:
            continue
        costs = held_back(behind, 0.0, 1e9, most, GAP) - follows
        own = goes - stays - POLITE * max(costs, 0.0)
        if own > gain or (has_to and best < 0):
            best, gain = lane, own
    return best


@borrowing
def change_to(world: Any, here: Any, n: int, lane: int) -> None:
    """Let a vehicle of the traffic go over to the lane beside its own; its way on is drawn anew."""
    real, whole = here.real, here.whole
    along, aside = abreast(world, here, n, lane)
    whole[LEAVES, n] = whole[PIECE, n]
    here.path[n, 0] = lane
    whole[SIZE, n], whole[PIECE, n] = 1, lane
    whole[POINT, n] = world.point_start[lane]
    real[ALONG, n], real[ASIDE, n], real[TURNED, n] = along, aside, 0.0
    look_ahead(world, here, n)


@borrowing
def passing_lane(world: Any, here: Any, n: int, near: Any) -> Any:
    """Return the lane on which an agent by rule gets round what stands ahead on its route.

    Nothing is remembered: where the agent is, and who is about, says what it does. It goes out
    where somebody stands ahead with room beyond, and the lane beside is free; it comes back as soon
    as its own lane is free again.

    Returns
    -------
    lane, holds
        The lane that it goes along, -1 for that of its route; and whether it has to come back and
        cannot yet.
    """
    real, whole = here.real, here.whole
    piece = here.path[n, whole[AT, n]]
    if world.beside[piece, 0] < 0 and world.beside[piece, 1] < 0:
        return -1, False
    speed, own, along = real[SPEED, n], real[LENGTH, n], real[ALONG, n]
    left = world.length[piece] - along
    count = neighbours(world, here, n, near)
    gap, ahead, back, behind = on_lane(world, here, n, piece, along, near, count)
    stands = gap < SIGHT and ahead < STANDING
    most = world.vehicles[whole[KIND, n], dynamics.ACCEL]
    for side in range(2):
        lane = world.beside[piece, side]
        if lane < 0 or world.usable[lane, whole[KIND, n]] == 0:
            continue
        out = real[ASIDE, n] if side == 0 else -real[ASIDE, n]
        there, _ = abreast(world, here, n, lane)
        free, its, last, follows = on_lane(world, here, n, lane, there, near, count)
        if out > OUT:
            clear = gap > ROOM and back > ROOM and not stands
            clear = clear and held_back(behind, speed, back, most, GAP) > -SAFE
            if clear:
                return -1, False
            return lane, left < RETURN
        if not stands or gap < (SWING if out < OUT / 3 else ROOM) or left < gap + own + RETURN:
            continue
        beyond = along + gap + 2.0 * own + BEYOND  # where it would be when it has passed
        if beyond + BEYOND > world.length[piece]:
            continue
        room, _, _, _ = on_lane(world, here, n, piece, beyond, near, count)
        if room < ROOM or free < SWING or last < ROOM:
            continue
        if held_back(follows, speed, last, most, GAP) > -SAFE and (
            held_back(speed, its, free, most, GAP) > -SAFE
        ):
            return lane, False
    return -1, False
