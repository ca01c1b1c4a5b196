"""The country of a place, from Natural Earth's boundaries at 1:10m (public domain).

References
----------
Natural Earth, "Admin 0 - Countries", version 4.1, naturalearthdata.com; ``training/countries.py``
makes the table from it. Borders are those that hold on the ground as Natural Earth sees it.
"""

from __future__ import annotations

from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cityx.system.tables import DATA, read_table

KM_PER_DEGREE = 111.2
TOWN = 3.0  # km from the middle of a border town within which it tells the country
REACH = 40.0  # km from a coast within which places at sea belong to a country: piers, small islands


class _Borders(NamedTuple):
    """Segments between countries, s of them; sides are rows of `codes`, -1 for the sea."""

    codes: tuple[str, ...]
    start: NDArray[np.float64]  # (s, 2) longitude and latitude
    end: NDArray[np.float64]  # (s, 2)
    sides: NDArray[np.int16]  # (s, 2) country on the left and on the right


@cache
def _borders() -> _Borders:
    with np.load(DATA / "places" / "countries.npz") as file:
        table = dict(file)
    count = table["count"]
    line = np.repeat(np.arange(len(count)), count)
    steps = np.zeros((len(line), 2), np.int64)
    begins = np.cumsum(count) - count
    inner = np.ones(len(line), bool)
    inner[begins] = False
    steps[inner] = np.column_stack([table["east"], table["north"]])
    walked = np.cumsum(steps, axis=0)
    points = (walked + (table["first"] - walked[begins])[line]) * float(table["quantum"])
    rows = np.flatnonzero(inner)
    codes = tuple(table["codes"].tolist())
    return _Borders(codes, points[rows - 1], points[rows], table["sides"][line[rows]])


@cache
def _border_towns() -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """Return the countries of border towns, and their (n, 2) latitudes and longitudes."""
    towns = read_table(DATA / "places" / "border_towns.toml")["towns"]
    return tuple(town[1] for town in towns), np.array([town[2:] for town in towns])


def _scale(latitude: float) -> NDArray[np.float64]:
    """Return the km of a degree east and north."""
    return KM_PER_DEGREE * np.array([np.cos(np.radians(latitude)), 1.0])


@lru_cache(maxsize=256)
def country_at(latitude: float, longitude: float) -> str:
    """Return the ISO 3166-1 alpha-2 code of the country at a place (WGS84 degrees).

    A place at sea belongs to the nearest country within `REACH`; the high seas have "". Along land
    borders the answer is right to about 1 km, the accuracy of the map; for some towns at borders a
    table decides.
    """
    codes, places = _border_towns()
    far = np.hypot(*((places - (latitude, longitude)) * _scale(latitude)[::-1]).T)
    if far.min() < TOWN:
        return codes[int(np.argmin(far))]
    borders = _borders()
    longitude = (longitude + 180.0) % 360.0 - 180.0
    (x0, y0), (x1, y1) = borders.start.T, borders.end.T
    met = np.flatnonzero((x0 <= longitude) != (x1 <= longitude))
    height = y0[met] + (longitude - x0[met]) / (x1[met] - x0[met]) * (y1[met] - y0[met])
    above = met[np.argsort(height)][np.count_nonzero(height <= latitude) :]
    # Inside a country an odd number of its lines lies to the north. Coasts are simplified, so that
    # an island may touch the shore behind it: of two countries that of the nearer line counts.
    around, first, count = np.unique(
        borders.sides[above].ravel(), return_index=True, return_counts=True
    )
    inside = np.flatnonzero((around >= 0) & (count % 2 == 1))
    if len(inside):
        return borders.codes[int(around[inside[np.argmin(first[inside])]])]
    return _nearest(borders, latitude, longitude)


def _nearest(borders: _Borders, latitude: float, longitude: float) -> str:
    """Return the country of the nearest coast, "" where there is none within reach."""
    scale = _scale(latitude)
    near = np.abs(borders.start[:, 1] - latitude) * KM_PER_DEGREE < 2 * REACH
    rows = np.flatnonzero(near & (borders.sides < 0).any(axis=1))
    start = (borders.start[rows] - (longitude, latitude)) * scale
    along = (borders.end[rows] - borders.start[rows]) * scale
    length = np.maximum((along**2).sum(axis=1), 1e-12)
    share = np.clip(-(start * along).sum(axis=1) / length, 0.0, 1.0)
    far = np.hypot(*(start + share[:, None] * along).T)
    if not len(far) or far.min() > REACH:
        return ""
    return borders.codes[int(borders.sides[rows[np.argmin(far)]].max())]
