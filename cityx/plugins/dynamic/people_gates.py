"""When people may cross: crosswalks that no vehicle is on, nor comes to, while they are on them."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.crosswalks import heads_of
from cityx.city.moments import moments_of
from cityx.city.signals import GO, STATE, Signals, states_at
from cityx.city.tracks import MOVER, Tracks
from cityx.city.walkable import Walkable
from cityx.plugins.dynamic.people_walk import Gates

TICK = 0.5  # seconds between the moments at which vehicles are looked for
ROOM = 0.6  # metres that people keep from vehicles
SOON = 2  # ticks before a vehicle comes, and after it has gone, in which nobody is in its way
ON_FOOT = ("pedestrian", "animal")


def gates_of(tracks: Tracks, signals: Signals | None, walkable: Walkable, duration: float) -> Gates:
    """Find when signals let people onto crosswalks, and when these are free of vehicles.

    Parameters
    ----------
    tracks
        What moves already; it does not give way.
    signals
        What signals show, None without any.
    walkable
        The walkable area with its crosswalks.
    duration
        Seconds.
    """
    ticks = int(np.ceil(duration / TICK)) + 1
    taken = np.zeros((walkable.crosswalks.count, ticks), bool)
    driving = tracks.take(~np.isin(tracks.kind, [MOVER[name] for name in ON_FOOT]))
    if driving.count and walkable.crosswalks.count:
        found = moments_of(driving, np.arange(ticks) * TICK)
        tree = shapely.STRtree(walkable.crosswalks.regions())
        box, crosswalk = tree.query(found.boxes(driving.size, ROOM), predicate="intersects")
        for shift in range(-SOON, SOON + 1):
            taken[crosswalk, np.clip(found.number[box] + shift, 0, ticks - 1)] = True
    return Gates(TICK, _shut(signals, walkable, ticks), taken)


def _shut(signals: Signals | None, walkable: Walkable, ticks: int) -> NDArray[np.bool_]:
    """(c, ticks) whether signals keep people off crosswalks."""
    shut = np.zeros((walkable.crosswalks.count, ticks), bool)
    head = heads_of(walkable.crosswalks, signals)
    ruled = np.flatnonzero(head >= 0)
    if signals is not None and len(ruled):
        go = [STATE[name] for name in (*GO, "off")]
        for number in range(ticks):
            shown = states_at(signals, number * TICK)[head[ruled]]
            shut[ruled, number] = ~np.isin(shown, go)
    return shut
