"""A made-up city in which things move."""

import numpy as np

from cityx.assets.vehicles.movers import size_of
from cityx.city import City, Frame, Layout
from cityx.city.tracks import GAIT, MOVER, Tracks

# Id, look, kind, gait, start, heading, metres per second.
CAR = (8, "car_sedan", "car", "ride", (0, 0, 0), 0.0, 5.0)
MAN = (9, "person_male_casual_2", "pedestrian", "walk", (3, 4, 0.12), np.pi / 2, 1.4)
RUNNER = (11, "person_female_sport_5", "pedestrian", "run", (-3, 4, 0.12), 0.3, 3.2)
BIKE = (10, "bicycle", "bicycle", "ride", (-9, 0, 0), 0.0, 4.0)


def moving(*movers, seconds=10.0):
    """Return a city of movers, each of which goes straight ahead."""
    n = len(movers)
    ids, looks, kinds, gaits, starts, headings, speeds = zip(*movers, strict=True)
    way = np.column_stack([np.cos(headings), np.sin(headings), np.zeros(n)])
    begin = np.array(starts, float)
    end = begin + way * np.array(speeds)[:, None] * seconds
    tracks = Tracks(
        np.array(ids, np.uint64), np.array([MOVER[k] for k in kinds], np.uint8), np.array(looks),
        np.full(n, "test/made-v1"), np.ones((n, 3), np.float32),
        np.array([size_of(look) for look in looks], np.float32), 2 * np.arange(n + 1),
        np.tile([0.0, seconds], n), np.stack([begin, end], axis=1).reshape(-1, 3),
        np.repeat(headings, 2), np.repeat(speeds, 2).astype(np.float32),
        np.repeat([GAIT[g] for g in gaits], 2).astype(np.uint8), np.zeros(2 * n, np.uint64),
    )  # fmt: skip
    return City("Moving", Frame(52.0, 13.0), Layout((-50, -50, 50, 50)), tracks=tracks)
