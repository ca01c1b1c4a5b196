"""Which vehicles fit along a line, what is in their way, and how the line leads round it."""

from __future__ import annotations

from math import atan2, cos, sin
from typing import Any

import numpy as np

from cityx.geometry.compiled import compiled
from cityx.sim.kernels.boxes import cell_of, cell_value, first_touched, wheels_off

X, Y, Z, HEADING, ALONG, LIFT = range(6)  # columns of points
LENGTH, WIDTH, HEIGHT, WHEELBASE, TRACK, STEER = range(6)  # columns of vehicles
FREE, OFF, BEND = -1, -2, -3  # nothing in the way; wheels beside the roadway; a bend too tight
CAR = 1  # row of vehicles that lines are led for
WHEELS = 2  # beside the roadway, from which one is off the road
STEP, SHIFTS = 0.2, 10  # metres between the lines that are tried, and how many to either side
AWAY, TURN = 1.0, 12.0  # cost of a square metre beside the middle, and of one aside per metre on
BORDER = 2.0  # metres from the border of the site, where streets are cut
MARGIN = 0.2  # metres of air to either side
# Metres of roadway beside the wheels: where a cell of the raster, by its middle, says roadway, the
# roadway reaches half a cell less.
BESIDE = 0.13


@compiled
def trailed(point: Any, first: int, last: int, base: float, heading: Any) -> Any:
    """Write where a body heads whose middle is on a line, and return its greatest slip, radians.

    Its rear axle goes where the body heads; its middle goes along the line, half a wheelbase
    ahead of it. So the body trails: in a bend its nose is outside and its tail inside of the line.

    Parameters
    ----------
    point, first, last
        The line.
    base
        Metres of the wheelbase.
    heading
        Takes an angle for each of the points.
    """
    now, most = point[first, HEADING], 0.0
    heading[0] = now
    for p in range(first + 1, last + 1):
        run = point[p, ALONG] - point[p - 1, ALONG]
        turn = point[p, HEADING] - point[p - 1, HEADING]
        for k in range(PARTS):
            tangent = point[p - 1, HEADING] + turn * (k + 0.5) / PARTS
            slip = tangent - now
            most = max(most, abs(slip))
            now += 2.0 / base * sin(slip) * run / PARTS
        heading[p - first] = now
    return most


EACH = 6  # rounds more for each point of a line
PARTS = 4  # of the way between two points in which a body trails
TRACKING = 0.08  # radians of slip that a driver saves by cutting a bend


@compiled
def near_border(x: float, y: float, reach: float, frame: Any) -> Any:
    """Return whether a place lies so near to the border of the site."""
    east, north = frame[0] + frame[2] * frame[3], frame[1] + frame[2] * frame[4]
    return min(min(x - frame[0], east - x), min(y - frame[1], north - y)) < reach + BORDER


@compiled
def in_the_way(
    x: float, y: float, z: float, heading: float, lift: float, vehicle: Any, flags: Any,
    clear: Any, frame: Any, segment: Any, cell_start: Any, cell_segment: Any, grid: Any,
) -> Any:  # fmt: skip
    """Return the segment that a vehicle in a place touches, `OFF` beside the roadway, or `FREE`."""
    half_length, half_width = vehicle[LENGTH] / 2, vehicle[WIDTH] / 2 + MARGIN
    row, column = cell_of(x, y, frame)
    if row < 0 or near_border(x, y, half_length, frame):
        return FREE  # beyond the site nobody knows
    if cell_value(clear, row, column) * 0.1 < half_length + half_width:
        hit = first_touched(x, y, z, heading, half_length, half_width, vehicle[HEIGHT], segment,
                            cell_start, cell_segment, grid)  # fmt: skip
        if hit >= 0:
            return hit
    if wheels_off(x, y, heading, vehicle[WHEELBASE] / 2, vehicle[TRACK] / 2 + BESIDE, lift, flags,
                  frame) >= WHEELS:  # fmt: skip
        return OFF
    return FREE


@compiled
def headings(point: Any, point_start: Any, vehicle: Any) -> Any:
    """Return where a vehicle that trails along lines heads at each of their points, (p,)."""
    found = np.empty(len(point))
    for n in range(len(point_start) - 1):
        first, last = point_start[n], point_start[n + 1] - 1
        trailed(point, first, last, vehicle[WHEELBASE], found[first : last + 1])
    return found


@compiled
def sweep(
    point: Any, point_start: Any, vehicles: Any, flags: Any, clear: Any, frame: Any, segment: Any,
    cell_start: Any, cell_segment: Any, grid: Any,
) -> Any:  # fmt: skip
    """Return what is first in the way of each vehicle along each line, (n, v) int32.

    The middle of a vehicle is on the line and its body trails. Segments count from 0; `FREE`,
    `OFF` and `BEND` are negative.
    """
    count, kinds = len(point_start) - 1, len(vehicles)
    found = np.full((count, kinds), FREE, np.int32)
    for n in range(count):
        first, last = point_start[n], point_start[n + 1] - 1
        heading = np.empty(last + 1 - first)
        for v in range(kinds):
            slip = trailed(point, first, last, vehicles[v, WHEELBASE], heading)
            for k in range(2 * (last - first) + 1):  # at each point, and half-way to it
                p = first + (k + 1) // 2
                b, t = max(p - 1, first), (k % 2) / 2
                turned = heading[p - first]
                what = in_the_way(
                    point[p, X] + t * (point[b, X] - point[p, X]),
                    point[p, Y] + t * (point[b, Y] - point[p, Y]), point[p, Z],
                    turned + t * (heading[b - first] - turned), point[p, LIFT], vehicles[v],
                    flags, clear, frame, segment, cell_start, cell_segment, grid,
                )  # fmt: skip
                if what == OFF and (k < 2 or k > 2 * (last - first) - 2):
                    continue  # half of it is on another piece, from which it comes at an angle
                if what != FREE:
                    found[n, v] = what
                    break
            if found[n, v] == FREE and slip > most_slip(vehicles[v]):
                found[n, v] = BEND
    return found


@compiled
def most_slip(vehicle: Any) -> Any:
    """Return the greatest slip of a body along a line that a vehicle can follow, radians."""
    return np.arctan(np.tan(vehicle[STEER]) / 2) + TRACKING


@compiled
def softened(point: Any, point_start: Any, vehicle: Any, rounds: int) -> Any:
    """Round the bends that are too tight for a vehicle; ends of lines stay.

    Points about such a bend go to the middle of their neighbours until it can be driven.

    Returns
    -------
    xy, changed
        (p, 2) metres, and (n,) whether a line is another now.
    """
    xy = point[:, :2].copy()
    changed = np.zeros(len(point_start) - 1, np.bool_)
    reach = vehicle[WHEELBASE] * 2.5
    for n in range(len(point_start) - 1):
        first, last = point_start[n], point_start[n + 1] - 1
        line = point[first : last + 1].copy()
        if last - first < 3 or (tightest(line, vehicle) < 0 and slipping(line, vehicle) < 0):
            continue
        size = len(line)
        for _ in range(rounds + EACH * size):  # long lines have many bends
            bend = tightest(line, vehicle)
            if bend < 0:
                bend = slipping(line, vehicle)
            if bend < 0:
                break
            before = line[:, :2].copy()
            for k in range(1, size - 1):
                if abs(line[k, ALONG] - line[bend, ALONG]) < reach:
                    for axis in range(2):
                        line[k, axis] = (before[k - 1, axis] + before[k, axis] * 2
                                         + before[k + 1, axis]) / 4  # fmt: skip
            measure(line)
        if slipping(line, vehicle) < 0 or tightest(line, vehicle) < 0:  # else nothing is gained
            changed[n] = True
            xy[first : last + 1] = line[:, :2]
    return xy, changed


@compiled
def tightest(line: Any, vehicle: Any) -> Any:
    """Return the point of a line about which it turns more than a vehicle can; -1 for none."""
    base, best, most = vehicle[WHEELBASE], -1, np.tan(vehicle[STEER])
    k = 0
    for p in range(len(line)):
        while line[p, ALONG] - line[k, ALONG] > base:
            k += 1
        turn = abs(line[p, HEADING] - line[k, HEADING])
        if turn > most:
            most, best = turn, (p + k) // 2
    return best


@compiled
def slipping(line: Any, vehicle: Any) -> Any:
    """Return the point of a line where a body slips most, if it is more than it can; else -1."""
    heading = np.empty(len(line))
    if trailed(line, 0, len(line) - 1, vehicle[WHEELBASE], heading) <= most_slip(vehicle):
        return -1
    return int(np.argmax(np.abs(line[:, HEADING] - heading)))


@compiled
def measure(line: Any) -> None:
    """Measure headings of a line and metres along it anew from where its points are."""
    size = len(line)
    line[0, ALONG] = 0.0
    before = 0.0
    for k in range(size - 1):
        dx, dy = line[k + 1, X] - line[k, X], line[k + 1, Y] - line[k, Y]
        line[k + 1, ALONG] = line[k, ALONG] + np.hypot(dx, dy)
        edge = atan2(dy, dx)
        if k > 0:
            edge += 2 * np.pi * np.round((before - edge) / (2 * np.pi))
        line[k, HEADING] = edge if k == 0 else (before + edge) / 2
        before = edge
    line[size - 1, HEADING] = before


@compiled
def ways_round(
    point: Any, point_start: Any, wanted: Any, room: Any, begin: Any, end: Any, vehicles: Any,
    weight: Any, flags: Any, clear: Any, frame: Any, segment: Any, cell_start: Any,
    cell_segment: Any, grid: Any,
) -> Any:  # fmt: skip
    """Find how far beside each point of some lines vehicles pass best, (p,) metres to the left.

    Of all ways from the one end to the other the cheapest is taken: costs are what of the vehicles
    does not fit, metres beside the middle, and steps aside.

    Parameters
    ----------
    point, point_start
        The lines.
    wanted
        (n,) bool, which lines.
    room
        (n,) metres that a line may be moved.
    begin, end
        (n,) metres beside its first and last point, NaN for any.
    vehicles, weight
        (v, 9) and (v,) what it costs where one does not fit.
    """
    width = 2 * SHIFTS + 1
    aside = np.zeros(len(point))
    for n in range(len(point_start) - 1):
        if not wanted[n]:
            continue
        first, last = point_start[n], point_start[n + 1] - 1
        size = last - first + 1
        cost = np.full((size, width), 1e18)
        came = np.zeros((size, width), np.int8)
        most = min(int(room[n] / STEP), SHIFTS)
        heading = np.empty(size)
        trailed(point, first, last, vehicles[CAR, WHEELBASE], heading)
        for q in range(size):
            p = first + q
            nx, ny = -sin(point[p, HEADING]), cos(point[p, HEADING])
            for k in range(width):
                shift = (k - SHIFTS) * STEP
                pinned = begin[n] if q == 0 else (end[n] if q == size - 1 else np.nan)
                if pinned == pinned:
                    if abs(pinned - shift) > STEP / 2:
                        continue
                elif abs(k - SHIFTS) > most:
                    continue
                own = AWAY * shift * shift
                for v in range(len(vehicles)):
                    for half in range(2 if q > 0 else 1):  # at the point, and half-way to it
                        b, t = max(p - 1, first), half / 2
                        what = in_the_way(
                            point[p, X] + t * (point[b, X] - point[p, X]) + shift * nx,
                            point[p, Y] + t * (point[b, Y] - point[p, Y]) + shift * ny,
                            point[p, Z], heading[q] + t * (heading[max(q - 1, 0)] - heading[q]),
                            point[p, LIFT], vehicles[v], flags, clear, frame, segment, cell_start,
                            cell_segment, grid,
                        )  # fmt: skip
                        if what != FREE:
                            own += weight[v]
                            break
                if q == 0:
                    cost[q, k] = own
                    continue
                run = max(point[p, ALONG] - point[p - 1, ALONG], 0.1)
                for d in range(-1, 2):
                    if 0 <= k + d < width and cost[q - 1, k + d] < 1e18:
                        step = d * STEP / run
                        total = cost[q - 1, k + d] + own + TURN * step * step * run
                        if total < cost[q, k]:
                            cost[q, k], came[q, k] = total, d
        best = int(np.argmin(cost[size - 1]))
        if cost[size - 1, best] >= 1e18:
            continue
        for q in range(size - 1, -1, -1):
            aside[first + q] = (best - SHIFTS) * STEP
            best += came[q, best]
    return aside
