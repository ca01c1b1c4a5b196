"""Check for running red lights: vehicles past stop lines, and people onto crosswalks."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.moments import moments_of
from cityx.city.signals import STATE, Signals, states_at
from cityx.city.tracks import MOVER, Tracks, travelled
from cityx.ground.walking.crosswalks import heads_of
from cityx.ground.walking.walkable import walk_areas

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

RED = (STATE["red"], STATE["red_yellow"])
EVERY = 0.5  # seconds between the moments at which people are looked at
REACTION = 1.0  # seconds of red after which whoever starts has seen it


def red_runners(city: City) -> BoolArray:
    """Return (n,) which movers pass a signal head that has shown red for a while.

    A vehicle passes between its last sample on the lane and the next; it runs the light when the
    head is red from before the first to the second.
    """
    tracks, signals = city.tracks, city.signals
    if tracks is None:
        return np.zeros(0, bool)
    runs = np.zeros(tracks.count, bool)
    if signals is None or not signals.count:
        return runs
    for mover, head, begin, end in (*_passing(tracks, signals), *_stepping(city, tracks, signals)):
        times = np.append(np.arange(begin - REACTION, end, EVERY), end)
        if all(states_at(signals, max(t, 0.0))[head] in RED for t in times.tolist()):
            runs[mover] = True
    return runs


def _passing(tracks: Tracks, signals: Signals) -> list[tuple[int, int, float, float]]:
    """Mover, head, and between which times it passes it, of every vehicle that leaves a lane."""
    place, mover = tracks.place, tracks.mover
    here = np.flatnonzero((place[:-1] > 0) & (place[1:] != place[:-1]) & (mover[1:] == mover[:-1]))
    # The lane that it comes to may be some samples ahead.
    known = np.where(place > 0, np.arange(len(place)), len(place))
    ahead = np.minimum.accumulate(known[::-1])[::-1]
    key = {(int(a), int(b)): row for row, (a, b) in enumerate(zip(signals.lane, signals.onto,
                                                                  strict=True)) if a}  # fmt: skip
    gone = travelled(tracks)
    found = []
    for at in here.tolist():
        there = int(ahead[at + 1])
        if there < len(place) and mover[there] == mover[at]:
            head = key.get((int(place[at]), int(place[there])))
            if head is not None:
                found.append((int(mover[at]), head, *_front_over(tracks, gone, at)))
    return found


def _front_over(tracks: Tracks, gone: FloatArray, at: int) -> tuple[float, float]:
    """Return the times between which the front passes where the middle is at a sample or after.

    Who obeys does so by the front; slow, its middle is past the line some seconds later.
    """
    mover = tracks.mover[at]
    own = slice(tracks.sample_start[mover], tracks.sample_start[mover + 1])
    places = gone[[at, at + 1]] - float(tracks.size[mover, 0]) / 2
    rises = np.r_[True, np.diff(gone[own]) > 0]  # who stands is where it is until it goes on
    begin, end = np.interp(places, gone[own][rises], _last_there(tracks.time[own], rises))
    return float(begin), float(end)


def _last_there(time: FloatArray, rises: BoolArray) -> FloatArray:
    """Return of every place that was reached when it was left."""
    last = np.r_[np.flatnonzero(rises)[1:] - 1, len(time) - 1]
    return np.asarray(time[last])


def _stepping(city: City, tracks: Tracks, signals: Signals) -> list[tuple[int, int, float, float]]:
    """Return the same of every person who steps onto a crosswalk that signals rule."""
    foot = np.flatnonzero(tracks.kind == MOVER["pedestrian"])
    if city.ground is None or city.network is None or not len(foot):
        return []
    area = walk_areas(city)
    head = heads_of(area.crosswalks, signals)
    found = moments_of(tracks.take(foot), np.arange(0.0, tracks.duration + EVERY / 2, EVERY))
    over = np.zeros(len(found.mover), np.int64)
    spot, crosswalk = shapely.STRtree(area.over).query(
        shapely.points(found.position[:, :2]), predicate="intersects"
    )
    over[spot] = crosswalk + 1
    steps = np.flatnonzero(
        (over[1:] > 0) & (over[:-1] == 0) & (found.mover[1:] == found.mover[:-1])
    )
    ruled = head[over[steps + 1] - 1]
    return [
        (int(foot[found.mover[at]]), int(row), float(found.time[at]), float(found.time[at + 1]))
        for at, row in zip(steps.tolist(), ruled.tolist(), strict=True)
        if row >= 0
    ]
