"""The plan "aerial": drone views, oblique and nadir, in one place or in flight."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import maximum_filter

from cityx.dataset.plans.motion import headings, smoothed
from cityx.dataset.plans.plan_site import Site
from cityx.dataset.plans.takes import Refusal, Source, Take, still
from cityx.errors import InputError
from cityx.geometry.airways import Airspace, Airways, airway, airways, rounded
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import draw, uniform

FOV = 65.0  # degrees
LOWEST, HIGHEST = 40.0, 120.0  # metres above the ground; 120 is the limit of the open category
NADIR = 0.25  # share of views straight down
_SLANT = (-60.0, -22.0)  # degrees of pitch of the others
CLEAR = 2.0  # metres round a drone that must be free
MARGIN = 5.0  # metres over roofs and trees at which drones fly
CELL, RISE = 6.0, 10.0  # metres of the lattice of the air
MOST_POINTS = 60_000  # of a layer of the lattice, beyond which its cells grow
LOOKS = 3  # rays along each side of a cell that look for what stands in it
SPEED = 8.0  # metres per second of a drone in flight
STEP = 1.0  # metres between the points of a way
ROUNDS = 60  # of rounding: corners get a radius of some 8 m
FARTHER = 4.0  # times as far as needed that goals are looked for
NEAREST = 60.0  # metres, at least, to the goal of a flight
TURN_S = 0.8  # seconds over which a turn is spread
BEYOND = 60.0  # metres by which an eye may stand outside of the site and look into it


def aerial(site: Site) -> Source:
    """Return the source of views from drones: single ones, or flights if sequences are asked for.

    Raises
    ------
    InputError
        If no air is free over the city up to the height that drones keep.
    """
    return _flights(site) if site.wishes.length > 1 else _stills(site)


def _stills(site: Site) -> Source:
    xmin, ymin, xmax, ymax = site.city.layout.extent
    low, size = np.array([xmin, ymin]), np.array([xmax - xmin, ymax - ymin])

    def candidates(numbers: IntArray) -> list[Take | Refusal]:
        drawn = site.draws("aerial", numbers, 3)
        more = uniform(site.wishes.seed, "dataset/aerial/view", numbers[:, None], np.arange(3))
        target = low + drawn[:, :2] * size
        height = LOWEST + (HIGHEST - LOWEST) * drawn[:, 2]
        down = more[:, 0] < NADIR
        slant = np.radians(_SLANT[0] + (_SLANT[1] - _SLANT[0]) * more[:, 1])
        heading = 2 * np.pi * more[:, 2]
        level = np.where(down, 0.0, height / np.tan(-slant))
        eye = target - level[:, None] * np.column_stack([np.sin(heading), np.cos(heading)])
        z = site.city.terrain.height_at(eye) + height
        drop = z - site.city.terrain.height_at(target)  # hillsides turn the view
        pitch = np.where(down, -np.pi / 2, -np.arctan2(drop, level))
        moment = site.moments(numbers)
        found: list[Take | Refusal] = []
        for row in range(len(numbers)):
            if (eye[row] < low - BEYOND).any() or (eye[row] > low + size + BEYOND).any():
                found.append(Refusal("beyond the map", f"the eye at {eye[row].round(1).tolist()}"))
                continue
            found.append(still(np.append(eye[row], z[row]), heading[row], pitch[row], moment[row],
                               site.wishes.fov(FOV), clearance=CLEAR))  # fmt: skip
        return found

    return candidates


def airspace_of(site: Site) -> Airspace:
    """Measure the free air over a city, by rays from above, up to the greatest height of drones."""
    xmin, ymin, xmax, ymax = site.city.layout.extent
    cell = max(CELL, float(np.sqrt((xmax - xmin) * (ymax - ymin) / MOST_POINTS)))
    columns, rows = int((xmax - xmin) // cell) + 1, int((ymax - ymin) // cell) + 1
    ground = float(site.city.terrain.heights.min())
    fine = (np.arange(LOOKS) + 0.5) / LOOKS - 0.5
    x = xmin + cell * (np.arange(columns)[:, None] + fine).ravel()
    y = ymin + cell * (np.arange(rows)[:, None] + fine).ravel()
    spots = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    sky = float(site.city.terrain.heights.max()) + 2000.0  # above whatever is built
    eyes = np.column_stack([spots, np.full(len(spots), sky)])
    hits = site.stage.cast(eyes, np.broadcast_to([0.0, 0.0, -1.0], eyes.shape))
    top = sky - np.asarray(hits.distance, float)
    top = np.where(np.isfinite(top), top, ground).reshape(rows, LOOKS, columns, LOOKS)
    height = maximum_filter(top.max(axis=(1, 3)), size=3, mode="nearest")
    floor = site.city.terrain.height_at(
        np.stack(np.meshgrid(xmin + cell * np.arange(columns), ymin + cell * np.arange(rows)),
                 axis=-1).reshape(-1, 2)
    ).reshape(rows, columns)  # fmt: skip
    layers = int((HIGHEST - LOWEST + np.ptp(site.city.terrain.heights)) // RISE) + 1
    lowest = np.maximum(height + MARGIN, floor + LOWEST)
    return Airspace(
        np.array([xmin, ymin, ground + LOWEST]), cell, RISE, lowest, floor + HIGHEST, layers
    )


def _flights(site: Site) -> Source:
    air = airspace_of(site)
    ways = airways(air.wider())
    if not len(ways.points):
        raise InputError(
            f"no air is free over {site.city.name} at {LOWEST:g} to {HIGHEST:g} m above the ground."
        )
    needed = SPEED * site.wishes.seconds

    def candidates(numbers: IntArray) -> list[Take | Refusal]:
        drawn = site.draws("flight", numbers, 3)
        low, high = ways.points.min(axis=0), ways.points.max(axis=0)
        wished = low + drawn * (high - low)
        moments = site.moments(numbers)
        rows = zip(numbers.tolist(), wished, moments.tolist(), strict=True)
        return [
            _flight(site, air, ways, number, spot, moment, needed) for number, spot, moment in rows
        ]

    return candidates


def _flight(
    site: Site,
    air: Airspace,
    ways: Airways,
    number: int,
    wished: FloatArray,
    moment: float,
    needed: float,
) -> Take | Refusal:
    seed = site.wishes.seed
    origin = int(np.argmin(((ways.points - wished) ** 2).sum(axis=1)))
    far = np.linalg.norm((ways.points - ways.points[origin])[:, :2], axis=1)
    least = max(needed * 1.05, NEAREST)
    fit = np.flatnonzero(
        (far >= least) & (far <= FARTHER * least) & (ways.component == ways.component[origin])
    )
    if not len(fit):
        return Refusal("the way ends", f"no free air {least:.0f} m away from "
                       f"{ways.points[origin].round(1).tolist()}")  # fmt: skip
    goal = int(fit[int(draw(seed, "dataset/flight/goal", number) * len(fit))])
    corners = airway(ways, origin, goal)
    assert corners is not None
    points = rounded(air, corners, STEP, ROUNDS)
    gone = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    time = np.arange(site.wishes.length) / site.wishes.rate
    place = SPEED * time

    def at(metres: FloatArray) -> FloatArray:
        return np.column_stack([np.interp(metres, gone, column) for column in points.T])

    way = at(np.minimum(place + SPEED, gone[-1])) - at(np.minimum(place, gone[-1] - STEP))
    heading = smoothed(headings(way[:, :2]), TURN_S * site.wishes.rate)
    share = draw(seed, "dataset/flight/pitch", number)
    pitch = np.radians(_SLANT[0] + (_SLANT[1] - _SLANT[0]) * (0.4 + 0.6 * share))
    return Take(
        at(place), heading, np.full(len(time), pitch), moment + time, site.wishes.fov(FOV),
        clearance=CLEAR, way=at(np.arange(0.0, place[-1], STEP)),
    )  # fmt: skip
