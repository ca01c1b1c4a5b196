"""When people may cross: crosswalks that no vehicle is on, nor comes to, while they are on them."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.city.moments import moments_of
from cityx.city.tracks import MOVER, Tracks
from cityx.city.walkable import Walkable
from cityx.plugins.dynamic.people_walk import Gates

TICK = 0.5  # seconds between the moments at which vehicles are looked for
ROOM = 0.6  # metres that people keep from vehicles
SOON = 2  # ticks before a vehicle comes, and after it has gone, in which nobody is in its way
ON_FOOT = ("pedestrian", "animal")


def gates_of(tracks: Tracks, walkable: Walkable, duration: float) -> Gates:
    """Find when crosswalks are free of the vehicles of tracks.

    Parameters
    ----------
    tracks
        What moves already; it does not give way.
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
    return Gates(TICK, np.zeros_like(taken), taken)
